#include "diagnosis/parts.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/parallel.h"
#include "diagnosis/policy.h"
#include "estimation/built_run.h"
#include "experiment/drive_by_record.h"
#include "identification/estimation_problem.h"
#include "model/kept_modes.h"

namespace dynoproof::diagnosis {
namespace {

/// Mean over channels of the logarithm of the power that a plan leaves in its free run.
double LogPowerOf(const Plan& plan, const Levels& levels) {
  const Result<Eigen::VectorXd> rows = levels[levels.free_run()].Innovations(plan);
  if (!rows.ok()) return std::numeric_limits<double>::infinity();
  double sum = 0.0;
  for (const estimation::Channel& channel : levels.data().channels())
    sum += std::log(std::max(rows->segment(channel.begin, channel.count).squaredNorm() /
                                 static_cast<double>(std::max<Eigen::Index>(1, channel.count)),
                             std::numeric_limits<double>::min()));
  return sum / static_cast<double>(levels.data().channels().size());
}

/// The excess of a plan's innovations over noise; nothing where its run breaks.
std::optional<LeftThere> LeftBeside(const Plan& plan, const Levels& levels, const estimation::Predictor& predictor) {
  const Result<estimation::Prediction> there = predictor.Predict(plan);
  if (!there.ok()) return std::nullopt;
  const std::vector<estimation::ChannelScale> scales =
      estimation::ScalesOf(levels.data(), there->innovations, there->noise_alone);
  return LeftThere{LogExcess(scales, levels.data()), IsExact(scales)};
}

/// At a level; of free runs that of the start which suits the plan better.
std::optional<LeftThere> LeftAt(const Plan& plan, const Levels& levels, std::size_t level) {
  const std::optional<LeftThere> led = LeftBeside(plan, levels, levels[level]);
  if (level != levels.free_run() || levels.from_the_start() == nullptr) return led;
  const std::optional<LeftThere> whole = LeftBeside(plan, levels, *levels.from_the_start());
  return !led || (whole && whole->log_excess < led->log_excess) ? whole : led;
}

/// Whether no test tells a plan's free run from one that leaves `own`.
bool NobodySees(const Levels& levels, const Plan& plan, const Eigen::VectorXd& own) {
  const Result<Eigen::VectorXd> rows = levels[levels.free_run()].Innovations(plan);
  return rows.ok() && std::ranges::all_of(levels.data().channels(), [&](const estimation::Channel& one) {
           const auto apart = rows->segment(one.begin, one.count) - own.segment(one.begin, one.count);
           return apart.norm() <= policy::kUnseen * one.noise;
         });
}

}  // namespace

double SearchedUntil(const Plan& plan, const std::vector<MappedRecord>& records) {
  const double period_s = plan.root.NumberOr("run.period_s", RunSettings{}.period_s);
  double until_s = policy::kSearchedSteps * period_s;
  for (const MappedRecord& record : records) {
    std::size_t samples = 1;
    for (const auto& [name, series] : record.outputs) samples = std::max(samples, series.values->size());
    until_s = std::max(until_s, policy::kSearchedSamples / static_cast<double>(samples) * record.end_s);
  }
  return std::min(until_s, policy::kMostSearchedSteps * period_s);
}

std::string KeepTo(std::size_t most, std::vector<MappedRecord>& records) {
  std::size_t samples = 0;
  for (const MappedRecord& record : records) {
    for (const auto& [name, series] : record.outputs) samples += series.values->size();
  }
  if (samples <= most) return "";
  const double share = static_cast<double>(most) / static_cast<double>(samples);
  for (MappedRecord& record : records) identification::CutRecord(record, share);
  return fmt::format("only the first {:.3g} % of the records are looked at: of {} samples no more than {}",
                     100.0 * share, samples, most);
}

Result<Parts> Split(const Plan& plan, const std::vector<MappedRecord>& data, const std::vector<MappedRecord>& holdout,
                    const Registry& registry) {
  constexpr double kAsWell = 1.5;  // times the power
  std::vector<MappedRecord> first = data, later = holdout.empty() ? data : holdout;
  if (holdout.empty()) {
    for (MappedRecord& record : first) {
      record = OntoClock(std::move(record), plan);
      identification::CutRecord(record, kFittedShare);
    }
  }
  const double most_s = SearchedUntil(plan, first);
  Result<std::unique_ptr<Levels>> training = Levels::Of(plan, first, registry, 0.0, kComparedRows, nullptr, most_s);
  if (!training.ok()) return training.failure();
  if (std::ranges::any_of(first, &MappedRecord::in_motion)) {
    std::vector<MappedRecord> at_rest = first;
    for (MappedRecord& record : at_rest) record.in_motion = false;
    Result<std::unique_ptr<Levels>> unled = Levels::Of(plan, at_rest, registry, 0.0, kComparedRows, nullptr, most_s);
    if (unled.ok() && LogPowerOf(plan, **unled) <= LogPowerOf(plan, **training) + std::log(kAsWell)) {
      training = std::move(unled);
      first = std::move(at_rest);
      if (holdout.empty()) {
        for (MappedRecord& record : later) record.in_motion = false;
      }
    }
  }
  const double from = holdout.empty() ? kFittedShare : 0.0;
  Result<std::unique_ptr<Levels>> held = Levels::Of(plan, later, registry, from, kComparedRows, training->get());
  if (!held.ok()) return held.failure();
  return Parts{*std::move(training), *std::move(held), std::move(first)};
}

Plan WithFewerModes(const Plan& plan, const Levels& levels) {
  if (!HasSoftRotors(plan) || RotorModes(plan) > 0) return plan;
  const Result<Eigen::VectorXd> own = levels[levels.free_run()].Innovations(plan);
  if (!own.ok()) return plan;
  for (const int modes : policy::kRotorModes) {
    Plan fewer = plan;
    SetRotorModes(fewer, modes);
    if (NobodySees(levels, fewer, *own)) return fewer;
  }
  return plan;
}

Plan InFewerSubsteps(const Plan& plan, const Levels& levels, const Registry& registry) {
  const Result<estimation::BuiltRun> run =
      estimation::BuildRun(StartingInto(plan, 0), levels.data().records().front(), registry);
  if (!run.ok() || run->solver->linear()) return plan;
  const Result<Eigen::VectorXd> own = levels[levels.free_run()].Innovations(plan);
  for (int substeps = 1; own.ok() && substeps < SubstepsOf(plan); substeps *= 2) {
    Plan fewer = plan;
    SetSubsteps(fewer, substeps);
    if (NobodySees(levels, fewer, *own)) return fewer;
  }
  return plan;
}

HeldOut LeftOf(const Plan& plan, const Levels& levels) {
  HeldOut all;
  for (std::size_t level = 0; level < levels.size(); ++level) all.push_back(LeftAt(plan, levels, level));
  return all;
}

std::vector<HeldOut> HeldOutOf(const Contest& contest, const Levels& held_out, const HeldOut& given, bool own) {
  std::vector<HeldOut> all(contest.contestants.size(), HeldOut(held_out.size()));
  ParallelFor(all.size(), 0, [&](std::size_t i) {
    const Contestant& one = contest.contestants[i];
    for (std::size_t level = contest.first; level < held_out.size(); ++level) {
      if (!one.Holds(level)) continue;
      Plan plan = one.hypothesis.At(one.levels[level].q);
      if (own) plan.root.Erase("of_record");
      all[i][level] = LeftAt(plan, held_out, level);
      if (all[i][level]) all[i][level]->log_excess -= given[level].value_or(LeftThere{}).log_excess;
    }
  });
  return all;
}

std::vector<double> LeastOf(const std::vector<std::vector<HeldOut>>& passes, std::size_t levels) {
  std::vector<double> least(levels, 0.0);
  for (const auto& pass : passes) {
    for (const HeldOut& one : pass) {
      for (std::size_t level = 0; level < levels; ++level)
        least[level] = std::min(least[level], one[level].value_or(LeftThere{}).log_excess);
    }
  }
  return least;
}

}  // namespace dynoproof::diagnosis
