#include "score/tube.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "score/jumps.h"
#include "score/sliding.h"

namespace dynoproof::score {
namespace {

// A held signal jumps: the value just left of a jump lives until the jump. Its tube must be known there, too.
std::vector<double> LeftLimits(const Series& series, std::span<const double> times_s) {
  std::vector<double> out(times_s.size());
  std::size_t j = 0;
  for (std::size_t i = 0; i < times_s.size(); ++i) {
    while (j + 1 < series.time_s.size() && series.time_s[j + 1] < times_s[i]) ++j;
    out[i] = series.values[j];
  }
  return out;
}

std::vector<double> Shifted(std::span<const double> times_s, double by) {
  std::vector<double> out(times_s.begin(), times_s.end());
  for (double& t : out) t += by;
  return out;
}

// Extremes of the reference within +-w of each point.
void ReferenceRange(const Series& reference, double w, TubePoints& points) {
  const std::vector<double> left = Shifted(points.time_s, -w), right = Shifted(points.time_s, w);
  const std::vector<double> at_left = SampleAt(reference, left), at_right = SampleAt(reference, right);
  const std::size_t n = points.time_s.size();
  points.low.resize(n);
  points.high.resize(n);
  SlidingExtremes inside(reference.time_s, reference.values);
  for (std::size_t i = 0; i < n; ++i) {
    points.low[i] = std::min(at_left[i], at_right[i]);
    points.high[i] = std::max(at_left[i], at_right[i]);
    inside.MoveTo(left[i], right[i]);
    if (inside.Empty()) continue;
    points.low[i] = std::min(points.low[i], inside.Min());
    points.high[i] = std::max(points.high[i], inside.Max());
  }
}

std::string OptionFault(const TubeOptions& o) {
  if (!(o.relative_width > 0.0) || !std::isfinite(o.relative_width)) return "tube: the relative width must be positive";
  if (!(o.nominal > 0.0) || !std::isfinite(o.nominal)) return "tube: the signal's nominal must be positive";
  if (!(o.time_half_width_s >= 0.0) || !std::isfinite(o.time_half_width_s))
    return "tube: the half-width in time must be zero or more";
  if (!(o.interpolation_room >= 0.0) || !std::isfinite(o.interpolation_room))
    return "tube: the room for interpolation must be zero or more";
  if (!(o.relative_width * o.nominal > std::numeric_limits<double>::min())) return "tube: the width in value vanishes";
  return {};
}

// Twice the largest second divided difference about the interval after sample j: what bends a signal there.
double BendAfter(const Series& series, std::size_t j) {
  const auto& [time, values, interpolation] = series;
  double most = 0.0;
  for (std::size_t i = j > 2 ? j - 1 : 1; i <= j + 2 && i + 1 < time.size(); ++i) {
    if (IsJump(time, i - 1) || IsJump(time, i)) continue;  // nothing bends across a jump
    const double before = (values[i] - values[i - 1]) / (time[i] - time[i - 1]);
    const double after = (values[i + 1] - values[i]) / (time[i + 1] - time[i]);
    most = std::max(most, 2.0 * std::abs(after - before) / (time[i + 1] - time[i - 1]));
  }
  return most;
}

// How far the interpolation of a signal may be off at each time: nothing at its samples.
std::vector<double> OpenBetween(const Series& series, std::span<const double> times_s) {
  const auto& [time, values, interpolation] = series;
  std::vector<double> open(times_s.size(), 0.0);
  std::size_t j = 0, bent = time.size();  // time[j] <= t < time[j + 1]; the interval that `bend` is of
  double bend = 0.0;
  for (std::size_t i = 0; i < times_s.size(); ++i) {
    while (j + 1 < time.size() && time[j + 1] <= times_s[i]) ++j;
    if (times_s[i] <= time[j] || j + 1 == time.size()) continue;
    if (interpolation == Interpolation::kHold) {
      open[i] = std::abs(values[j + 1] - values[j]);
      continue;
    }
    if (bent != j) bend = BendAfter(series, bent = j);
    open[i] = 0.5 * bend * (times_s[i] - time[j]) * (time[j + 1] - times_s[i]);
  }
  return open;
}

// The samples from `from` to `to`.
Series Part(const Series& series, double from, double to) {
  const auto first = std::lower_bound(series.time_s.begin(), series.time_s.end(), from);
  const auto last = std::upper_bound(first, series.time_s.end(), to);
  const auto offset = static_cast<std::size_t>(first - series.time_s.begin());
  const auto count = static_cast<std::size_t>(last - first);
  return {series.time_s.subspan(offset, count), series.values.subspan(offset, count), series.interpolation};
}

// Every time of either signal inside the part of the reference's span that is judged, once.
std::vector<double> UnionTimes(const Series& reference, const Series& test, const TubeOptions& o) {
  const double from = std::max(reference.time_s.front(), o.from_s), to = std::min(reference.time_s.back(), o.to_s);
  std::vector<double> times;
  times.reserve(reference.time_s.size() + test.time_s.size());
  std::merge(reference.time_s.begin(), reference.time_s.end(), test.time_s.begin(), test.time_s.end(),
             std::back_inserter(times));
  times.erase(std::unique(times.begin(), times.end()), times.end());
  std::erase_if(times, [&](double t) { return t < from || t > to; });
  return times;
}

}  // namespace

TubeResult CompareTube(const Series& reference, const Series& test, const TubeOptions& options) {
  TubeResult result;
  result.worst_ratio = std::numeric_limits<double>::quiet_NaN();
  result.reason = OptionFault(options);
  if (!result.reason.empty()) return result;
  result.reason = FaultOf(reference, "reference");
  if (!result.reason.empty()) return result;
  const Aligned covered = AlignTo(Part(reference, options.from_s, options.to_s), test, options.max_gap_s);
  if (!covered.ok()) {
    result.reason = covered.reason;
    return result;
  }

  const double h = options.relative_width * options.nominal;
  TubePoints points{UnionTimes(reference, test, options), {}, {}, {}};
  const std::vector<double>& times = points.time_s;
  points.test = SampleAt(test, times);
  ReferenceRange(reference, options.time_half_width_s, points);
  if (options.interpolation_room > 0.0) {
    const std::vector<double> of_reference = OpenBetween(reference, times), of_test = OpenBetween(test, times);
    for (std::size_t i = 0; i < times.size(); ++i) {
      const double room = options.interpolation_room * (of_reference[i] + of_test[i]);
      points.low[i] -= room;
      points.high[i] += room;
    }
  }
  JudgeJumps(reference, test, options.interpolation_room, options.time_half_width_s > 0.0, points);
  // Just before each instant the held test still has its old value; the reference may have jumped with it. With room
  // for interpolation the instant of a jump is known to a step only.
  const bool held = test.interpolation == Interpolation::kHold && options.interpolation_room == 0.0;
  const std::vector<double> old_values = held ? LeftLimits(test, times) : points.test;
  const bool reference_held = reference.interpolation == Interpolation::kHold;
  const std::vector<double> old_reference = held && reference_held
                                                ? LeftLimits(reference, Shifted(times, -options.time_half_width_s))
                                                : std::vector<double>();

  result.worst_ratio = 0.0;
  result.worst_time_s = times.front();
  result.from_s = times.front();
  result.to_s = times.back();
  result.points = times.size();
  double outside_s = 0.0;
  bool was_outside = false;
  for (std::size_t i = 0; i < times.size(); ++i) {
    double value = points.test[i];
    double low = points.low[i];
    double high = points.high[i];
    double ratio = std::max({0.0, (value - high) / h, (low - value) / h});
    if (held && i > 0 && !IsJump(times, i - 1)) {
      const double low_before = old_reference.empty() ? low : std::min(low, old_reference[i]);
      const double high_before = old_reference.empty() ? high : std::max(high, old_reference[i]);
      const double before = std::max({0.0, (old_values[i] - high_before) / h, (low_before - old_values[i]) / h});
      if (before > ratio) {
        ratio = before;
        value = old_values[i];
        low = low_before;
        high = high_before;
      }
    }
    result.test.push_back(value);
    result.lower.push_back(low - h);
    result.upper.push_back(high + h);
    result.ratio.push_back(ratio);
    if (ratio > result.worst_ratio) {
      result.worst_ratio = ratio;
      result.worst_time_s = times[i];
    }
    const bool outside = !(ratio <= 1.0);
    if (outside && !result.first) result.first = Divergence{times[i], value, low - h, high + h};
    if (i > 0) outside_s += 0.5 * (times[i] - times[i - 1]) * ((outside ? 1.0 : 0.0) + (was_outside ? 1.0 : 0.0));
    was_outside = outside;
  }
  result.fraction_outside = outside_s / (result.to_s - result.from_s);
  result.time_s = std::move(points.time_s);

  if (result.first) {
    result.reason = fmt::format(
        "leaves the tube at {:.6g} s: {:.6g} where {:.6g} to {:.6g} is allowed; outside for {:.3g} % of the time, at "
        "worst "
        "{:.3g} half-widths at {:.6g} s",
        result.first->time_s, result.first->test, result.first->lower, result.first->upper,
        100.0 * result.fraction_outside, result.worst_ratio, result.worst_time_s);
    return result;
  }
  result.verdict = Verdict::kPass;
  return result;
}

Check TubeCheck(const TubeResult& result, std::string name, std::string origin) {
  return ToCheck(result, std::move(name), "tube", result.worst_ratio, 1.0, "half-widths", std::move(origin));
}

}  // namespace dynoproof::score
