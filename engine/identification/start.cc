#include "identification/start.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>

#include "base/parallel.h"
#include "experiment/drive_by_record.h"
#include "identification/noise_model.h"
#include "linear/dense.h"

namespace dynoproof::identification {
namespace {

/// Of a start's prior spread: far above round-off, and an impact more or less is not to be met.
constexpr double kShareOfSpread = 1e-3;

constexpr Eigen::Index kFirst = 3;  // samples: a model that is a little off has hardly gone astray by then

/// The weight of each row: one over the spread of its channel.
Eigen::VectorXd WeightsOf(const EstimationProblem& problem) {
  Eigen::VectorXd weights(problem.measured().size());
  for (const ComparedOutput& c : problem.channels())
    weights.segment(c.begin, c.count).setConstant(1.0 / std::max(c.spread, 1e-12 * c.nominal));
  return weights;
}

double Read(const Plan& plan, std::size_t record, const std::string& path) {
  return plan.root.NumberOr(StartOfRecord(record) + "." + path, plan.root.NumberOr(path, 0.0));
}

}  // namespace

namespace {

/// Whether a run is off from the beginning, and not only after a while, as a model that is a little off would be: by each of the first
/// three samples or, where noise hides that, by two averages over the first ones, of which the second has not grown.
bool IsOffAtOnce(const Eigen::VectorXd& errors, double spread, double noise) {
  constexpr double kShare = 0.01, kSigmas = 6.0;  // of the spread; of the noise
  constexpr double kGrown = 0.25, kApart = 3.0;   // of the first average; of the noise of their difference
  if (errors.head(kFirst).cwiseAbs().minCoeff() > std::max(kShare * spread, kSigmas * noise)) return true;
  for (const Eigen::Index n : {4, 12}) {
    if (errors.size() < 2 * n) break;
    const double first = errors.head(n).mean(), second = errors.segment(n, n).mean(), count = static_cast<double>(n);
    const double least = std::max(kShare * spread, kSigmas * noise / std::sqrt(count));
    if (first * second > 0.0 && std::min(std::abs(first), std::abs(second)) > least &&
        std::abs(second - first) < kApart * noise * std::sqrt(2.0 / count) + kGrown * std::abs(first))
      return true;
  }
  return false;
}

}  // namespace

std::string MotionAtStart(const EstimationProblem& problem) {
  const Result<Eigen::VectorXd> predicted = problem.PredictPlan(problem.plan());
  if (!predicted.ok()) return "";
  std::string text;
  bool moves = false;
  for (const ComparedOutput& c : problem.channels()) {
    if (c.record != 0 || c.count < kFirst) continue;
    // By the time that an output begins late, a model that is a little off has gone astray.
    const std::vector<double>& time = *problem.records().front().outputs.at(c.name).time;
    if (time.front() > static_cast<double>(kFirst) * (time[1] - time[0])) continue;
    const auto rows = problem.measured().segment(c.begin, c.count);
    moves = moves || IsOffAtOnce(rows - predicted->segment(c.begin, c.count), c.spread, HighFrequencyFloor(rows));
    text += fmt::format("{}{} at {:.4g} {} and not {:.4g}", text.empty() ? "" : ", ", c.name, rows[0], c.unit,
                        (*predicted)[c.begin]);
  }
  return moves ? text : "";
}

Result<Plan> FitStarts(const EstimationProblem& problem, Plan plan, double until) {
  const std::vector<MappedRecord>& records = problem.records();
  if (std::none_of(records.begin(), records.end(), [](const MappedRecord& one) { return one.in_motion; })) return plan;
  std::vector<const Nuisance*> starts;
  for (const Nuisance& nuisance : problem.nuisances()) {
    if (nuisance.start) starts.push_back(&nuisance);
  }
  if (starts.empty()) return plan;
  for (std::size_t r = 0; r < records.size(); ++r) {
    if (!records[r].in_motion) continue;
    // A start moves its own record alone: the others are not run for it.
    const EstimationProblem own(problem.plan(), {records[r]}, problem.registry(), until, problem.context());
    const auto predict = [&](const std::vector<double>& values) {
      Plan moved = plan;
      moved.root.Erase("of_record");
      for (std::size_t k = 0; k < starts.size(); ++k)
        WriteNumber(moved.root, StartOfRecord(0) + "." + starts[k]->path, values[k]);
      return own.PredictPlan(moved);
    };
    std::vector<double> values;
    for (const Nuisance* start : starts) values.push_back(Read(plan, r, start->path));
    const Result<Eigen::VectorXd> before = predict(values);
    if (!before.ok()) return before.failure();
    const Eigen::VectorXd weight = WeightsOf(own);
    Eigen::MatrixXd slopes(before->size(), static_cast<Eigen::Index>(starts.size()));
    std::vector<Status> failed(starts.size());
    ParallelFor(starts.size(), 0, [&](std::size_t k) {
      std::vector<double> moved = values;
      moved[k] += kShareOfSpread * starts[k]->spread;
      const Result<Eigen::VectorXd> after = predict(moved);
      if (after.ok())
        slopes.col(static_cast<Eigen::Index>(k)) = (*after - *before).cwiseProduct(weight) / kShareOfSpread;
      else
        failed[k] = after.failure();
    });
    for (const Status& one : failed) {
      if (one) return *one;
    }
    const Eigen::VectorXd error = (own.measured() - *before).cwiseProduct(weight);
    // What the record does not show stays at its nominal value: the smallest of all solutions.
    const Eigen::VectorXd z = dense::LeastSquares(slopes, error);
    for (std::size_t k = 0; k < starts.size(); ++k)
      WriteNumber(plan.root, StartOfRecord(r) + "." + starts[k]->path,
                  values[k] + starts[k]->spread * z[static_cast<Eigen::Index>(k)]);
  }
  return plan;
}

namespace {

/// Squares of what a plan leaves over the first share of the records, each channel over its spread; infinite where a run breaks.
double LeftOf(const EstimationProblem& problem, const Plan& plan) {
  const Result<Eigen::VectorXd> predicted = problem.PredictPlan(plan);
  if (!predicted.ok()) return std::numeric_limits<double>::infinity();
  return (problem.measured() - *predicted).cwiseProduct(WeightsOf(problem)).squaredNorm();
}

/// The plan after steps over the first share of the records, while these halve what is left there.
Plan StepsOver(const EstimationProblem& problem, Plan plan, double until) {
  constexpr int kMostSteps = 8;
  const EstimationProblem first(problem.plan(), problem.records(), problem.registry(), until, problem.context());
  double left = LeftOf(first, plan);
  for (int step = 0; step < kMostSteps; ++step) {
    Result<Plan> next = FitStarts(problem, plan, until);
    const double of_next = next.ok() ? LeftOf(first, *next) : std::numeric_limits<double>::infinity();
    const bool halves = of_next < 0.5 * left;
    if (of_next < left) plan = *std::move(next), left = of_next;
    if (!halves) break;
  }
  return plan;
}

}  // namespace

Result<Plan> FindStarts(const EstimationProblem& problem, const Plan& plan, double until) {
  constexpr double kRowsPerNumber = 5.0, kLonger = 2.0, kAsWell = 1.01;
  const Result<Plan> once = FitStarts(problem, plan, until);
  if (!once.ok()) return once;
  const auto starts = std::ranges::count_if(problem.nuisances(), &Nuisance::start);
  if (starts == 0 || once->root.Find("of_record") == nullptr) return once;
  double share = 0.0;  // of the records, in which every output has rows enough, one that begins late as well
  for (const MappedRecord& record : problem.records()) {
    for (const auto& [name, series] : record.outputs) {
      const auto row = static_cast<std::size_t>(kRowsPerNumber * static_cast<double>(starts));
      share = std::max(share, (*series.time)[std::min(row, series.time->size()) - 1] / record.end_s);
    }
  }
  Plan found = plan;
  for (; share < until; share *= kLonger) found = StepsOver(problem, std::move(found), share);
  found = StepsOver(problem, std::move(found), until);
  const EstimationProblem first(problem.plan(), problem.records(), problem.registry(), until, problem.context());
  return LeftOf(first, *once) <= kAsWell * LeftOf(first, found) ? *once : found;
}

Plan WithStartsWritten(const EstimationProblem& problem, Plan plan) {
  for (std::size_t r = 0; r < problem.records().size(); ++r) {
    for (const Nuisance& nuisance : problem.nuisances()) {
      if (nuisance.start) WriteNumber(plan.root, StartOfRecord(r) + "." + nuisance.path, Read(plan, r, nuisance.path));
    }
  }
  return plan;
}

Result<Start> StartOf(const Plan& plan, const MappedRecord& record, const Registry& registry) {
  if (!record.in_motion || record.outputs.empty()) return Start();
  const EstimationProblem problem(plan, {record}, registry);
  const Result<Plan> found = FindStarts(problem, problem.plan());
  if (!found.ok()) return found.failure();
  Start start;
  for (const Nuisance& nuisance : problem.nuisances()) {
    if (nuisance.start) start[nuisance.path] = Read(*found, 0, nuisance.path);
  }
  return start;
}

std::string ToText(const Start& start) {
  std::string text;
  for (const auto& [path, value] : start) text += fmt::format("{}{} = {:.4g}", text.empty() ? "" : ", ", path, value);
  return text;
}

}  // namespace dynoproof::identification
