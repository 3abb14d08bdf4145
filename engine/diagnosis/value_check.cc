#include "diagnosis/value_check.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>

#include "score/series.h"

namespace dynoproof::diagnosis {
namespace {

/// Share of the other steps that change the value, in a signal that else never stands still.
constexpr double kElse = 0.9;

/// Runs of the same value, in samples.
struct Still {
  std::size_t first = 0, length = 0;
  std::size_t end() const { return first + length; }
};
std::vector<Still> RunsOf(const std::vector<double>& x, std::size_t shortest) {
  std::vector<Still> runs;
  for (std::size_t i = 0; i < x.size();) {
    std::size_t end = i + 1;
    while (end < x.size() && x[end] == x[i]) ++end;
    if (end - i >= shortest) runs.push_back({i, end - i});
    i = end;
  }
  return runs;
}

/// Whether a signal that else changes with nearly every sample comes to a run from a step as large as its usual ones, or leaves it so: what
/// comes to rest by itself slows down before, what rests at the beginning or at the end was never seen to come or go.
bool StopsInMotion(const std::vector<double>& x, const Still& run) {
  if (run.first == 0 || run.end() == x.size()) return false;
  std::vector<double> steps;
  for (std::size_t i = 1; i < x.size(); ++i) {
    if (i <= run.first || i > run.end()) steps.push_back(std::abs(x[i] - x[i - 1]));
  }
  if (steps.size() < run.length) return false;
  const auto moving = static_cast<double>(std::ranges::count_if(steps, [](double step) { return step > 0.0; }));
  std::ranges::nth_element(steps, steps.begin() + std::ssize(steps) / 2);
  const double usual = steps[steps.size() / 2];
  return moving >= kElse * static_cast<double>(steps.size()) &&
         std::max(std::abs(x[run.first] - x[run.first - 1]), std::abs(x[run.end()] - x[run.end() - 1])) > usual;
}

/// Runs of the same extreme value: a converter at its end. A pulse has one, and only one that stops in motion tells; a converter has many.
void CheckClipping(const trace::Column& column, const std::vector<double>* time, std::vector<Finding>& findings) {
  constexpr std::size_t kShortest = 4, kAlone = 8;  // samples
  const std::vector<double>& x = column.values;
  const auto [low, high] = std::minmax_element(x.begin(), x.end());
  const std::vector<Still> still = RunsOf(x, kShortest);
  for (const double level : {*low, *high}) {
    std::vector<Still> runs;
    std::ranges::copy_if(still, std::back_inserter(runs), [&](const Still& run) { return x[run.first] == level; });
    std::size_t clipped = 0;
    for (const Still& run : runs) clipped += run.length;
    if (runs.empty() || clipped > x.size() / 2) continue;
    if (runs.size() < 2 && !(runs[0].length >= kAlone && StopsInMotion(x, runs[0]))) continue;
    findings.push_back({false, "clipping", column.name,
                        fmt::format("{} samples in {} run{} stay at {:.6g}, the first in row {}: if the sensor ends "
                                    "there, tell the scenario, sensor = [{{ type = \"range\", {} }}]",
                                    clipped, runs.size(), runs.size() > 1 ? "s" : "", level, runs[0].first,
                                    level == *high ? fmt::format("low = ..., high = {:.6g}", level)
                                                   : fmt::format("low = {:.6g}, high = ...", level)),
                        clipped, time != nullptr ? (*time)[runs[0].first] : 0.0});
  }
}

/// A few samples far away from all others: a code such as -9999 where there is no value, or a spike of the line.
void CheckOutliers(const trace::Column& column, const std::vector<double>* time, std::vector<Finding>& findings) {
  // No bounded signal of a plant has crest factors of thirty; codes of missing values have hundreds.
  constexpr double kFar = 30.0, kMost = 0.05;  // spreads of the rest; share of the samples
  const std::vector<double>& x = column.values;
  std::vector<double> sorted = x;
  std::sort(sorted.begin(), sorted.end());
  const double middle = sorted[sorted.size() / 2];
  // The rest: without the most distant samples, at either end.
  const auto cut = static_cast<std::size_t>(kMost * static_cast<double>(x.size()));
  const std::vector<double> rest(sorted.begin() + static_cast<std::ptrdiff_t>(cut),
                                 sorted.end() - static_cast<std::ptrdiff_t>(cut));
  const double spread = score::StandardDeviation(rest);
  if (!(spread > 0.0)) return;
  std::size_t count = 0, first = 0;
  double farthest = 0.0;
  for (std::size_t i = 0; i < x.size(); ++i) {
    const double away = std::abs(x[i] - middle) / spread;
    if (away <= kFar) continue;
    if (count++ == 0) first = i;
    farthest = std::max(farthest, away);
  }
  if (count == 0 || count > cut) return;
  const bool code = std::all_of(
      x.begin(), x.end(), [&](double value) { return std::abs(value - middle) <= kFar * spread || value == x[first]; });
  findings.push_back(
      {false, "outlier", column.name,
       fmt::format("{} samples{} lie up to {:.0f} spreads of the rest away, the first in row {} ({:g}){}", count,
                   code && count > 1 ? fmt::format(" of one value, {:g},", x[first]) : "", farthest, first, x[first],
                   code && count > 1 ? ": a code for a missing value?" : ""),
       count, time != nullptr ? (*time)[first] : 0.0});
}

/// A value that stands still for a while in a signal that else changes with every sample: a sensor that has stopped.
void CheckFrozen(const trace::Column& column, const std::vector<double>* time, std::vector<Finding>& findings) {
  constexpr std::size_t kLong = 10;  // samples
  const std::vector<double>& x = column.values;
  std::size_t still = 0, runs = 0, first = 0, longest = 0, changes = 0;
  for (const Still& run : RunsOf(x, 1)) {
    if (run.length >= kLong) {
      if (runs++ == 0) first = run.first;
      still += run.length, longest = std::max(longest, run.length);
    } else {
      ++changes;
    }
  }
  if (runs == 0 || 2 * still > x.size() || static_cast<double>(changes) < kElse * static_cast<double>(x.size() - still))
    return;
  const auto [low, high] = std::minmax_element(x.begin(), x.end());
  if (x[first] == *low || x[first] == *high) return;  // clipped
  findings.push_back(
      {false, "frozen", column.name,
       fmt::format("{} samples in {} runs of up to {} stand still, the first from row {}; else each differs "
                   "from the last",
                   still, runs, longest, first),
       still, time != nullptr ? (*time)[first] : 0.0});
}

}  // namespace

void CheckValues(const trace::Column& column, const std::vector<double>* time, std::vector<Finding>& findings) {
  CheckClipping(column, time, findings);
  CheckOutliers(column, time, findings);
  CheckFrozen(column, time, findings);
}

}  // namespace dynoproof::diagnosis
