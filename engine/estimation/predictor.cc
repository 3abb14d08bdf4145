#include "estimation/predictor.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/random.h"
#include "base/subnormals.h"
#include "estimation/sensor_chain.h"
#include "experiment/drive_by_record.h"
#include "score/series.h"
#include "sim/simulate.h"

namespace dynoproof::estimation {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

constexpr double kOnTick = 1e-3;  // of a period: a stamp so near a tick is there
constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

/// A course by tick at an instant; between ticks the straight line.
double At(const std::vector<double>& course, double time_s, double period_s) {
  double tick = std::clamp(time_s / period_s, 0.0, static_cast<double>(course.size() - 1));
  if (std::abs(tick - std::round(tick)) < kOnTick) tick = std::round(tick);
  const auto before = static_cast<std::size_t>(tick);
  const double share = tick - static_cast<double>(before);
  return share > 0.0 ? course[before] + share * (course[before + 1] - course[before]) : course[before];
}

/// Error of a sensor where its chain begins, in the unit of the nominal sensor.
class SensorError {
 public:
  /// A delayed sensor shows what was before: a sample counts at the first tick after the instant that it tells of, and is
  /// compared with the run before that tick's own correction.
  SensorError(const Rig& rig, std::size_t output, double nominal_slope, const Series* measured, double period_s)
      : rig_(rig), chain_(rig, output), inverse_(chain_.lag_s()), slope_(nominal_slope), period_s_(period_s) {
    if (measured == nullptr) return;
    measured_.assign(static_cast<std::size_t>(rig.steps) + 1, kNone);
    passed_.assign(measured_.size(), 1.0);
    for (std::size_t i = 0; i < measured->time->size(); ++i) {
      const double tick = ((*measured->time)[i] - chain_.delay_s()) / period_s;
      const double next = std::abs(tick - std::round(tick)) < kOnTick ? std::round(tick) : std::ceil(tick);
      if (!(next >= 0.0) || next > static_cast<double>(rig.steps)) continue;
      const auto k = static_cast<std::size_t>(next);
      measured_[k] = (*measured->values)[i];
      passed_[k] = std::min(1.0, 1.0 - (next - tick));
    }
  }

  const SensorChain& chain() const { return chain_; }
  /// At each tick, in order, where the run stands; 0 where there is no sample, or the sensor does not react.
  double At(const Frame& frame, std::size_t tick) {
    constexpr double kDead = 1e-3;  // of the nominal slope
    const double before = end_, now = frame.signals[static_cast<std::size_t>(chain_.end())];
    end_ = now;
    if (measured_.empty() || !std::isfinite(measured_[tick])) return 0.0;
    const double share = tick == 0 ? 1.0 : passed_[tick];
    const double error = inverse_(measured_[tick] - (share < 1.0 ? before + share * (now - before) : now),
                                  static_cast<double>(tick - last_) * period_s_);
    last_ = tick;
    const double slope = chain_.SlopeAt(frame, rig_.SecondsOf(frame.time));
    return std::abs(slope) > kDead * slope_ ? error * slope_ / slope : 0.0;
  }

 private:
  const Rig& rig_;
  SensorChain chain_;
  LagInverse inverse_;
  double slope_, period_s_, end_ = 0.0;
  std::vector<double> measured_, passed_;  // by tick; passed: of the period before, when the sample's instant was
  std::size_t last_ = 0;
};

/// A column of an observer for each output, by what the run's modes are.
class Corrections {
 public:
  Corrections(const Observer& observer, const BuiltRun& run) : observer_(observer), run_(run) {}

  Correction& For(const std::vector<int>& modes) {
    if (last_ != nullptr && run_.rig->modes == 0) return *last_;
    std::unique_ptr<Correction>& own = by_modes_[modes];
    if (own == nullptr) own = run_.solver->MakeCorrection(observer_.GainsFor(*run_.rig, modes));
    last_ = own.get();
    return *last_;
  }

 private:
  Correction* last_ = nullptr;
  const Observer& observer_;
  const BuiltRun& run_;
  std::map<std::vector<int>, std::unique_ptr<Correction>> by_modes_;
};

/// The finest step of a record's outputs [s].
double StepOf(const MappedRecord& record) {
  double step_s = std::numeric_limits<double>::infinity();
  for (const auto& [name, series] : record.outputs) step_s = std::min(step_s, score::MedianStep(*series.time));
  return step_s;
}

}  // namespace

Predictor::Predictor(const DataSet& data, const LinearModel& model, const Registry& registry,
                     std::optional<double> memory_s, std::shared_ptr<mechanics::Decompositions> decompositions)
    : data_(&data), model_(&model), registry_(&registry), decompositions_(std::move(decompositions)) {
  observer_ = ObserverOf(memory_s);
}

Predictor::Predictor(const Predictor& lead, double until_s, std::optional<double> memory_s)
    : data_(lead.data_),
      model_(lead.model_),
      registry_(lead.registry_),
      leads_(lead.leads_),
      decompositions_(lead.decompositions_) {
  leads_.push_back({lead.observer_, until_s});
  observer_ = ObserverOf(memory_s);
}

std::optional<Observer> Predictor::ObserverOf(std::optional<double> memory_s) const {
  if (!memory_s || model_->part.basis.cols() == 0) return std::nullopt;
  VectorXd noise(std::ssize(model_->outputs));
  for (Index j = 0; j < noise.size(); ++j)
    noise[j] =
        std::ranges::find(data_->channels(), model_->outputs[static_cast<std::size_t>(j)], &Channel::name)->noise;
  return Observer(*model_, noise, StepOf(data_->records().front()), *memory_s);
}

Status Predictor::RunBeside(const BuiltRun& run, const MappedRecord& record, std::size_t r,
                            VectorXd& innovations) const {
  const FlushSubnormals flush;
  const Rig& rig = *run.rig;
  const double period_s = rig.SecondsOf(rig.period);
  const std::size_t count = model_->outputs.size();
  std::vector<std::size_t> lines;
  std::vector<SensorError> sensors;
  std::vector<std::vector<double>> predicted;
  for (std::size_t j = 0; j < count; ++j) {
    const std::string& name = model_->outputs[j];
    const auto line = std::ranges::find(rig.outputs, name, &OutputLine::name);
    const auto series = record.outputs.find(name);
    if (line == rig.outputs.end()) return Failure{"the plan lost this output", name};
    lines.push_back(static_cast<std::size_t>(line - rig.outputs.begin()));
    sensors.emplace_back(rig, lines.back(), model_->slopes[static_cast<Index>(j)],
                         series != record.outputs.end() ? &series->second : nullptr, period_s);
    predicted.emplace_back(static_cast<std::size_t>(rig.steps) + 1);
  }
  Simulation simulation(rig, *run.solver);
  if (Status failed = simulation.Start()) return failed;
  auto lead = leads_.begin();
  std::unique_ptr<Corrections> corrections;
  const auto correct_by = [&](const std::optional<Observer>& observer) {
    corrections = observer ? std::make_unique<Corrections>(*observer, run) : nullptr;
  };
  correct_by(lead != leads_.end() ? lead->observer : observer_);
  std::vector<double> errors(count);
  for (std::int64_t step = 0; step <= rig.steps; ++step) {
    const auto k = static_cast<std::size_t>(step);
    if (Status failed = simulation.Tick()) return failed;
    // A delayed sample would have been corrected by what it is compared with: the delay is counted when they are compared.
    for (std::size_t j = 0; j < count; ++j)
      predicted[j][k] = free_run() ? simulation.OutputSample(lines[j])
                                   : simulation.frame().signals[static_cast<std::size_t>(sensors[j].chain().end())];
    if (step == rig.steps) break;
    for (; lead != leads_.end() && !(static_cast<double>(step) * period_s < lead->until_s); ++lead)
      correct_by(std::next(lead) != leads_.end() ? std::next(lead)->observer : observer_);
    if (corrections) {
      for (std::size_t j = 0; j < count; ++j) errors[j] = sensors[j].At(simulation.frame(), k);
      simulation.Correct(corrections->For(simulation.frame().modes), errors);
    }
    if (Status failed = simulation.Integrate()) return failed;
  }
  for (const Channel& channel : data_->channels()) {
    if (channel.record != r) continue;
    const auto j = static_cast<std::size_t>(std::ranges::find(model_->outputs, channel.name) - model_->outputs.begin());
    const double late_s = free_run() ? 0.0 : sensors[j].chain().delay_s();
    for (Index i = channel.begin; i < channel.begin + channel.count; ++i)
      innovations[i] =
          data_->measured()[i] - At(predicted[j], data_->time_s()[static_cast<std::size_t>(i)] - late_s, period_s);
  }
  return {};
}

Result<VectorXd> Predictor::Innovations(const Plan& plan) const {
  VectorXd innovations(data_->measured().size());
  for (std::size_t r = 0; r < data_->records().size(); ++r) {
    const Result<BuiltRun> run =
        BuildRun(StartingInto(plan, r), data_->records()[r], *registry_, decompositions_.get());
    if (!run.ok()) return run.failure();
    ++simulations_;
    if (Status failed = RunBeside(*run, data_->records()[r], r, innovations)) return *failed;
  }
  if (!innovations.allFinite()) return Failure{"a prediction is not finite", plan.id};
  return innovations;
}

bool Predictor::IsRough(const Plan& plan) const {
  const Result<BuiltRun> run =
      BuildRun(StartingInto(plan, 0), data_->records().front(), *registry_, decompositions_.get());
  return run.ok() && run->rig->guards > 0;
}

VectorXd Predictor::NoiseAlone(const Plan& plan) const {
  VectorXd alone(std::ssize(data_->channels()));
  for (Index c = 0; c < alone.size(); ++c) alone[c] = data_->channels()[static_cast<std::size_t>(c)].noise;
  if (free_run()) return alone;
  const MappedRecord& record = data_->records().front();
  const auto built = [&](const Plan& one) {
    return BuildRun(StartingInto(one, 0), record, *registry_, decompositions_.get());
  };
  const Result<BuiltRun> whole = built(plan);
  const Result<BuiltRun> bare = whole.ok() && HasSensors(plan) ? built(WithoutSensors(plan)) : Failure{};
  const Result<LinearModel> own = whole.ok() ? model_->Reduced(*whole, bare.ok() ? *bare : *whole) : Failure{};
  VectorXd white(std::ssize(model_->outputs));
  for (Index j = 0; j < white.size(); ++j)
    white[j] =
        std::ranges::find(data_->channels(), model_->outputs[static_cast<std::size_t>(j)], &Channel::name)->white;
  if (!own.ok() && learned_.size() > 0) return learned_;
  const VectorXd by_output = observer_->NoiseAlone(own.ok() ? *own : *model_, white);
  for (Index c = 0; c < alone.size(); ++c) {
    const std::string& name = data_->channels()[static_cast<std::size_t>(c)].name;
    alone[c] = std::max(alone[c], by_output[std::ranges::find(model_->outputs, name) - model_->outputs.begin()]);
  }
  return alone;
}

void Predictor::LearnNoise(const Plan& nominal) {
  constexpr std::uint64_t kSeed = 1;
  if (free_run() || !(leads_.empty())) return;
  const auto run_beside = [&](bool louder) -> Result<VectorXd> {
    VectorXd innovations = VectorXd::Zero(data_->measured().size());
    for (std::size_t r = 0; r < data_->records().size(); ++r) {
      MappedRecord record = data_->records()[r];
      const Result<BuiltRun> run = BuildRun(StartingInto(nominal, r), record, *registry_, decompositions_.get());
      if (!run.ok()) return run.failure();
      if (model_->Reduced(*run, *run).ok()) return Failure{"it is linear"};
      std::uint64_t stream = r * model_->outputs.size();
      for (auto& [name, series] : record.outputs) {
        const auto channel = std::ranges::find(data_->channels(), name, &Channel::name);
        std::vector<double> values = *series.values;
        for (std::size_t i = 0; louder && channel != data_->channels().end() && i < values.size(); ++i)
          values[i] += channel->white * RandomNormal(kSeed, stream, i);
        series.values = std::make_shared<const std::vector<double>>(std::move(values));
        ++stream;
      }
      ++simulations_;
      if (Status failed = RunBeside(*run, record, r, innovations)) return *failed;
    }
    return innovations;
  };
  const Result<VectorXd> as_is = run_beside(false), louder = run_beside(true);
  if (!as_is.ok() || !louder.ok() || !as_is->allFinite() || !louder->allFinite()) return;
  VectorXd learned(std::ssize(data_->channels()));
  for (Index c = 0; c < learned.size(); ++c) {
    const Channel& channel = data_->channels()[static_cast<std::size_t>(c)];
    const auto moved = (*louder - *as_is).segment(channel.begin, channel.count);
    learned[c] = std::hypot(channel.noise,
                            std::sqrt(moved.squaredNorm() / static_cast<double>(std::max<Index>(1, channel.count))));
  }
  learned_ = learned;
}

}  // namespace dynoproof::estimation
