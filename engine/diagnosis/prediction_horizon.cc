#include "diagnosis/prediction_horizon.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <memory>

#include "base/random.h"
#include "diagnosis/policy.h"
#include "identification/noise_model.h"

namespace dynoproof::diagnosis {
namespace {

constexpr double kFirst = 10.0;                 // periods
constexpr double kLonger = 3.1622776601683795;  // sqrt(10): two windows a decade
constexpr double kFewest = 5.0;     // windows in a record: fewer begin from too few states to tell their spread
constexpr std::uint64_t kMade = 3;  // records by which the noise's share is told
// Times what the noise alone causes: over four windows and twelve made ones, each of which begins with one error of the
// state, the ratio of both stays below in nineteen of twenty cases (root of the F quantile of 4 and 12: 1.8).
constexpr double kAtNoise = 1.8;

/// RMS error of the nominal model by output, over the output's spread; outputs without an entry in `noise` are left out.
Result<std::map<std::string, double>> ErrorsOf(const EstimationProblem& problem,
                                               const std::map<std::string, double>& noise) {
  const Result<Eigen::VectorXd> predicted = problem.Predict(problem.Nominal());
  if (!predicted.ok()) return predicted.failure();
  std::map<std::string, double> errors;
  for (const Channel& channel : problem.channels()) {
    if (!noise.contains(channel.name)) continue;
    const auto rows = problem.measured().segment(channel.begin, channel.count);
    errors[channel.name] = RmsOf(rows - predicted->segment(channel.begin, channel.count)) /
                           std::max(channel.spread, 1e-12 * channel.nominal);
  }
  return errors;
}

/// The record as it would be if the nominal model were right: its free run, and white noise of the same size.
Result<MappedRecord> MadeRecord(const EstimationProblem& problem, const std::map<std::string, double>& noise,
                                std::uint64_t seed) {
  const Result<Eigen::VectorXd> predicted = problem.Predict(problem.Nominal());
  if (!predicted.ok()) return predicted.failure();
  MappedRecord made = problem.records().front();
  std::uint64_t stream = 0;
  for (const Channel& channel : problem.channels()) {
    const auto rows = predicted->segment(channel.begin, channel.count);
    std::vector<double> values(rows.begin(), rows.end());
    const auto floor = noise.find(channel.name);
    for (std::size_t i = 0; i < values.size() && floor != noise.end(); ++i)
      values[i] += floor->second * channel.spread * RandomNormal(seed, stream, i);
    ++stream;
    made.outputs.at(channel.name).values = std::make_shared<const std::vector<double>>(std::move(values));
  }
  return made;
}

constexpr double kMostPeriods = 2e4;  // of a record are looked at: 2 s of a drive line
// The observer costs the cube of the states at each tick: 40 of them take a second for each second of a record.
constexpr std::size_t kMostStates = 40;

}  // namespace

Result<std::optional<PredictionHorizon>> PredictionHorizonOf(const Plan& plan, MappedRecord record,
                                                             const Registry& registry) {
  const double period_s = plan.root.NumberOr("run.period_s", RunSettings().period_s);
  CutRecord(record, std::min(1.0, kMostPeriods * period_s / std::max(record.end_s, period_s)));
  Plan free = plan;
  free.root.Erase("prediction_window_s");
  const EstimationProblem whole(free, {record}, registry);
  PredictionHorizon horizon;
  for (const Channel& channel : whole.channels()) {
    if (channel.count < policy::kBlocks * 10 || !(channel.spread > 1e-12 * channel.nominal)) continue;
    const auto rows = whole.measured().segment(channel.begin, channel.count);
    horizon.noise[channel.name] = std::max(HighFrequencyFloor(rows) / channel.spread, policy::kResolution);
  }
  const Result<std::size_t> states = whole.States();
  if (!states.ok()) return states.failure();
  if (*states > kMostStates) return std::optional<PredictionHorizon>();
  const double end_s = record.end_s;
  if (horizon.noise.empty() || kFewest * kFirst * period_s > end_s) return std::optional<PredictionHorizon>();
  std::vector<MappedRecord> made;
  for (std::uint64_t seed = 1; seed <= kMade; ++seed) {
    Result<MappedRecord> one = MadeRecord(whole, horizon.noise, seed);
    if (!one.ok()) return one.failure();
    made.push_back(*std::move(one));
  }
  const auto level = [&](std::optional<double> window_s) -> Result<PredictionLevel> {
    Plan windowed = free;
    if (window_s) windowed.root["prediction_window_s"] = Value(*window_s);
    auto errors = ErrorsOf(EstimationProblem(windowed, {record}, registry), horizon.noise);
    if (!errors.ok()) return errors.failure();
    PredictionLevel result{window_s, *std::move(errors), {}, true};
    for (const MappedRecord& one : made) {
      const auto noise = ErrorsOf(EstimationProblem(windowed, {one}, registry), horizon.noise);
      if (!noise.ok()) return noise.failure();
      for (const auto& [name, error] : *noise)
        result.by_noise[name] = std::hypot(result.by_noise[name], error / std::sqrt(static_cast<double>(kMade)));
    }
    for (const auto& [name, error] : result.nrmse)
      result.at_noise = result.at_noise && error <= kAtNoise * result.by_noise.at(name);
    return result;
  };
  bool within = true;
  for (double window_s = kFirst * period_s; kFewest * window_s <= end_s; window_s *= kLonger) {
    Result<PredictionLevel> one = level(window_s);
    if (!one.ok()) return one.failure();
    within = within && one->at_noise;
    if (within) horizon.horizon_s = window_s;
    horizon.levels.push_back(*std::move(one));
  }
  Result<PredictionLevel> all = level(std::nullopt);
  if (!all.ok()) return all.failure();
  if (all->at_noise) horizon.horizon_s = end_s;
  horizon.levels.push_back(*std::move(all));
  return std::optional(std::move(horizon));
}

std::string PredictionHorizon::ToText() const {
  std::string text = fmt::format("\n  {:<22}", "NRMSE, predicted for");
  for (const auto& [name, floor] : noise) text += fmt::format("{:>24}", name);
  text += "\n";
  for (const PredictionLevel& level : levels) {
    text += fmt::format("  {:<22}", level.window_s ? fmt::format("{:.3g} s", *level.window_s) : "all (free run)");
    for (const auto& [name, floor] : noise)
      text += fmt::format("{:>24}", fmt::format("{:.3g} ({:.3g})", level.nrmse.at(name), level.by_noise.at(name)));
    text += level.at_noise ? "  noise\n" : "\n";
  }
  text += "  in brackets: what the record's noise alone causes";
  if (levels.back().at_noise) return text + "\n  the model predicts the whole record to its noise\n";
  if (horizon_s > 0.0)
    return text +
           fmt::format("\n  the model predicts {:.3g} s ahead to the noise: what it lacks is small, or adds up\n",
                       horizon_s);
  return text +
         fmt::format("\n  the model is off within {:.3g} s: a force is missing or wrong\n", *levels.front().window_s);
}

}  // namespace dynoproof::diagnosis
