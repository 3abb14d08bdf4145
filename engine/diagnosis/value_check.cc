#include "diagnosis/value_check.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "score/series.h"

namespace dynoproof::diagnosis {
namespace {

/// Runs of the same extreme value: a converter at its end.
void CheckClipping(const trace::Column& column, const std::vector<double>* time, std::vector<Finding>& findings) {
  const std::vector<double>& x = column.values;
  const auto [low, high] = std::minmax_element(x.begin(), x.end());
  for (const double level : {*low, *high}) {
    std::size_t clipped = 0, runs = 0, first = 0;
    for (std::size_t i = 0; i < x.size();) {
      std::size_t end = i;
      while (end < x.size() && x[end] == level) ++end;
      if (end - i >= 4) {
        if (runs++ == 0) first = i;
        clipped += end - i;
      }
      i = std::max(end, i + 1);
    }
    // Twice the same run at the extreme value: a pulse has one, a converter at its end many.
    if (runs < 2 || clipped > x.size() / 2) continue;
    const double at = time != nullptr ? (*time)[first] : 0.0;
    findings.push_back(
        {false, "clipping", column.name,
         fmt::format("{} samples in {} runs stay at {:.6g}, the first in row {}", clipped, runs, level, first), clipped,
         at});
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
  constexpr double kElse = 0.9;      // share of the other steps that change the value
  const std::vector<double>& x = column.values;
  std::size_t still = 0, runs = 0, first = 0, longest = 0, changes = 0;
  for (std::size_t i = 0; i < x.size();) {
    std::size_t end = i + 1;
    while (end < x.size() && x[end] == x[i]) ++end;
    const std::size_t length = end - i;
    if (length >= kLong) {
      if (runs++ == 0) first = i;
      still += length, longest = std::max(longest, length);
    } else {
      ++changes;
    }
    i = end;
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
