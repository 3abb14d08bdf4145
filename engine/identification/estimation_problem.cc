#include "identification/estimation_problem.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <memory>

#include "experiment/drive_by_record.h"
#include "experiment/prepare.h"
#include "model/motion.h"
#include "score/series.h"
#include "sim/simulate.h"
#include "sim/solver.h"

namespace dynoproof::identification {
namespace {

constexpr int kFewestSubsteps = 4;  // substeps for dry friction beside undamped modes: the engine's default

bool HasUndampedShaft(const Plan& plan) {
  const Value* shafts = plan.root.FindPath("plant.shaft");
  const std::vector<std::string> names = shafts != nullptr ? KeysOf(*shafts) : std::vector<std::string>();
  return std::any_of(names.begin(), names.end(), [&](const std::string& name) {
    const Value& shaft = *shafts->Find(name);
    const Value* damping = shaft.Find(KeyIn(MotionIn(plan.root), shaft, "damping_Nms_per_rad"));
    return damping == nullptr || (damping->is_number() && damping->number() == 0.0);
  });
}

Series Cut(const Series& series, double end_s) {
  const auto rows = std::upper_bound(series.time->begin(), series.time->end(), end_s) - series.time->begin();
  if (rows == static_cast<std::ptrdiff_t>(series.time->size())) return series;
  return {std::make_shared<const std::vector<double>>(series.time->begin(), series.time->begin() + rows),
          std::make_shared<const std::vector<double>>(series.values->begin(), series.values->begin() + rows)};
}

/// A plan driven by a record.
Result<std::unique_ptr<Prepared>> Drive(Plan plan, const MappedRecord& record, const Registry& registry) {
  PrepareOptions options;
  options.solver = "realtime";
  options.data = &record;
  Diagnostics diagnostics;
  const std::string id = plan.id;
  std::unique_ptr<Prepared> prepared = Prepare(std::move(plan), options, registry, diagnostics);
  if (prepared != nullptr) return prepared;
  return Failure{
      diagnostics.items().empty() ? "the plan cannot be built" : diagnostics.items().front().message, id, {}, 2};
}

/// The simulated output at the measured time stamps; between ticks the straight line.
void SampleInto(const Samples& samples, const std::vector<double>& simulated, const std::vector<double>& time,
                double period_s, Eigen::Ref<Eigen::VectorXd> into) {
  const auto last = static_cast<double>(samples.time.size() - 1);
  for (std::size_t i = 0; i < time.size(); ++i) {
    double tick = std::min(time[i] / period_s, last);
    if (std::abs(tick - std::round(tick)) < 1e-3) tick = std::round(tick);
    const auto before = static_cast<std::size_t>(tick);
    const double share = tick - static_cast<double>(before);
    const double next = share > 0.0 ? simulated[before + 1] : simulated[before];
    into[static_cast<Eigen::Index>(i)] = simulated[before] + share * (next - simulated[before]);
  }
}

}  // namespace

void CutRecord(MappedRecord& record, double until) {
  record.end_s *= until;
  for (auto* signals : {&record.inputs, &record.outputs}) {
    for (auto& [name, series] : *signals) series = Cut(series, record.end_s);
  }
}

EstimationProblem::EstimationProblem(Plan plan, std::vector<MappedRecord> records, const Registry& registry,
                                     double until, SearchContext context)
    : plan_(std::move(plan)), registry_(&registry), records_(std::move(records)), context_(std::move(context)) {
  if (!records_.empty()) StartFromRecord(records_.front(), registry, plan_);
  for (MappedRecord& record : records_) {
    record = OntoClock(std::move(record), plan_);
    if (until < 1.0) CutRecord(record, until);
  }
  nuisances_ = NuisancesOf(plan_, registry, context_.released);
  if (std::none_of(records_.begin(), records_.end(), [](const MappedRecord& record) { return record.in_motion; }))
    std::erase_if(nuisances_, [](const Nuisance& nuisance) { return nuisance.only_in_motion; });
  if (const std::optional<double> window_s = PredictionWindow(plan_)) Observe(*window_s);
  Eigen::Index rows = 0;
  for (std::size_t r = 0; r < records_.size(); ++r) {
    for (const auto& [name, series] : records_[r].outputs) {
      const std::string path = "output." + name;
      channels_.push_back({r, name, plan_.root.TextOr(path + ".unit", "1"), plan_.root.NumberOr(path + ".nominal", 1.0),
                           score::MedianStep(*series.time), score::StandardDeviation(*series.values), rows,
                           static_cast<Eigen::Index>(series.time->size())});
      rows += channels_.back().count;
    }
  }
  measured_.resize(rows);
  time_s_.reserve(static_cast<std::size_t>(rows));
  for (const ComparedOutput& channel : channels_) {
    const Series& series = records_[channel.record].outputs.at(channel.name);
    measured_.segment(channel.begin, channel.count) =
        Eigen::Map<const Eigen::VectorXd>(series.values->data(), channel.count);
    time_s_.insert(time_s_.end(), series.time->begin(), series.time->end());
  }
}

void EstimationProblem::Observe(double window_s) {
  // Every window starts from an estimated state: the one at the beginning of the record is forgotten. Of parts that are
  // too short for a window too: hypotheses go from one part to another.
  std::erase_if(nuisances_, [](const Nuisance& nuisance) { return nuisance.start; });
  for (MappedRecord& record : records_) {
    const Result<std::unique_ptr<Prepared>> prepared = Drive(plan_, record, *registry_);
    Result<Observer> observer =
        prepared.ok() ? MakeObserver(*(*prepared)->rig, record, window_s) : Result<Observer>(prepared.failure());
    if (!observer.ok()) {
      unobserved_ = observer.failure();
      return;
    }
    observers_.push_back(std::move(*observer));
    for (auto& [name, series] : record.outputs) series = From(series, window_s);
  }
}

Plan EstimationProblem::PlanOf(const Hypothesis& hypothesis) const {
  Plan plan = plan_;
  ApplyNuisances(nuisances_, hypothesis.z, plan);
  for (const EffectInstance& instance : hypothesis.effects)
    instance.effect->Apply(plan, instance.place, instance.parameters);
  if (NeedsFinerSteps(hypothesis)) SetSubsteps(plan, std::max(kFewestSubsteps, SubstepsOf(plan)));
  return plan;
}

bool EstimationProblem::NeedsFinerSteps(const Hypothesis& hypothesis) const {
  return !PredictionWindow(plan_) && HasUndampedShaft(plan_) &&
         std::any_of(hypothesis.effects.begin(), hypothesis.effects.end(),
                     [](const EffectInstance& instance) { return instance.effect->info().traits.dry_friction; });
}

Result<Eigen::VectorXd> EstimationProblem::Predict(const Hypothesis& hypothesis) const {
  return PredictPlan(PlanOf(hypothesis));
}

Result<Eigen::VectorXd> EstimationProblem::PredictPlan(const Plan& plan) const {
  if (unobserved_) return *unobserved_;
  Eigen::VectorXd predicted(measured_.size());
  for (std::size_t r = 0; r < records_.size(); ++r) {
    const Result<std::unique_ptr<Prepared>> prepared = Drive(StartingInto(plan, r), records_[r], *registry_);
    if (!prepared.ok()) return prepared.failure();
    const Rig& rig = *(*prepared)->rig;
    const Result<std::unique_ptr<Solver>> solver = MakeRealtimeSolver(rig, context_.decompositions.get());
    if (!solver.ok()) return solver.failure();
    const Result<Samples> samples =
        observers_.empty() ? Simulate(rig, **solver) : PredictInWindows(rig, **solver, observers_[r]);
    if (!samples.ok()) return samples.failure();
    for (const ComparedOutput& channel : channels_) {
      if (channel.record != r) continue;
      const auto line = std::find_if(rig.outputs.begin(), rig.outputs.end(),
                                     [&](const OutputLine& output) { return output.name == channel.name; });
      if (line == rig.outputs.end()) return Failure{"the plan lost this output", channel.name};
      SampleInto(*samples, samples->outputs[static_cast<std::size_t>(line - rig.outputs.begin())],
                 *records_[r].outputs.at(channel.name).time, rig.SecondsOf(rig.period),
                 predicted.segment(channel.begin, channel.count));
    }
  }
  return predicted;
}

}  // namespace dynoproof::identification
