#include "score/hull.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "base/within.h"
#include "score/sliding.h"

namespace dynoproof::score {
namespace {

struct Ends {
  std::vector<double> from, to;
};

struct Points {
  std::vector<double> time_s, value;
};

HullCurve Slide(std::span<const double> time, const Points& high, const Points& low, const Ends& ends) {
  HullCurve hull;
  hull.time_s.assign(time.begin(), time.end());
  hull.upper.resize(time.size());
  hull.lower.resize(time.size());
  SlidingExtremes highs(high.time_s, high.value), lows(low.time_s, low.value);
  for (std::size_t i = 0; i < time.size(); ++i) {
    highs.MoveTo(ends.from[i], ends.to[i]);
    lows.MoveTo(ends.from[i], ends.to[i]);
    // A refined peak may have moved out of a window that holds its sample only; the neighbour inside is as good.
    hull.upper[i] = highs.Empty() ? high.value[i] : highs.Max();
    hull.lower[i] = lows.Empty() ? low.value[i] : lows.Min();
  }
  hull.verdict = Verdict::kPass;
  return hull;
}

// The signal with each well-sampled maximum (sign = 1) or minimum (-1) replaced by the vertex of its parabola.
Points Refined(const Series& signal, const HullCurve& raw, double sign) {
  Points points{{signal.time_s.begin(), signal.time_s.end()}, {signal.values.begin(), signal.values.end()}};
  for (std::size_t i = 1; i + 1 < signal.values.size(); ++i) {
    const double left = sign * signal.values[i - 1];
    const double peak = sign * signal.values[i];
    const double right = sign * signal.values[i + 1];
    if (peak < left || peak < right || (peak == left && peak == right)) continue;
    const double middle = sign * 0.5 * (raw.upper[i] + raw.lower[i]);
    if (peak - std::min(left, right) > 0.5 * (peak - middle)) continue;
    const double h1 = signal.time_s[i - 1] - signal.time_s[i];  // negative
    const double h2 = signal.time_s[i + 1] - signal.time_s[i];
    const double s1 = (left - peak) / h1;
    const double s2 = (right - peak) / h2;
    const double curvature = (s2 - s1) / (h2 - h1);
    const double slope = s1 - curvature * h1;
    if (!(curvature < 0.0)) continue;
    const double shift = -0.5 * slope / curvature;
    if (!(shift > h1 && shift < h2)) continue;
    points.time_s[i] = signal.time_s[i] + shift;
    points.value[i] = sign * (peak + 0.5 * slope * shift);
  }
  return points;
}

HullCurve HullWithin(const Series& signal, const Ends& ends) {
  const Points samples{{signal.time_s.begin(), signal.time_s.end()}, {signal.values.begin(), signal.values.end()}};
  const HullCurve raw = Slide(signal.time_s, samples, samples, ends);
  return Slide(signal.time_s, Refined(signal, raw, 1.0), Refined(signal, raw, -1.0), ends);
}

HullCurve Refuse(std::string reason) {
  HullCurve hull;
  hull.reason = std::move(reason);
  return hull;
}

}  // namespace

HullCurve Hull(const Series& signal, double window_s) {
  if (std::string fault = FaultOf(signal, "signal", 3); !fault.empty()) return Refuse(std::move(fault));
  const double step = MedianStep(signal.time_s);
  const double record = signal.time_s.back() - signal.time_s.front();
  if (!(window_s >= 2.0 * step && window_s <= record))
    return Refuse(
        fmt::format("hull: a window of {:.6g} s is not between two steps ({:.3g} s) and the record ({:.6g} s)",
                    window_s, 2.0 * step, record));
  Ends ends;
  for (double t : signal.time_s) {
    ends.from.push_back(t - 0.5 * window_s);
    ends.to.push_back(t + 0.5 * window_s);
  }
  return HullWithin(signal, ends);
}

HullCurve AdaptiveHull(const Series& signal, std::span<const double> frequency_hz, double periods, double longest_s) {
  if (std::string fault = FaultOf(signal, "signal", 3); !fault.empty()) return Refuse(std::move(fault));
  if (frequency_hz.size() != signal.values.size())
    return Refuse(fmt::format("hull: {} frequencies for {} samples", frequency_hz.size(), signal.values.size()));
  const double record = signal.time_s.back() - signal.time_s.front();
  const double shortest = 2.0 * MedianStep(signal.time_s);
  if (!(periods > 0.0) || !std::isfinite(periods)) return Refuse("hull: the number of periods must be positive");
  if (!(longest_s >= shortest && longest_s <= record))
    return Refuse(fmt::format("hull: the longest window {:.6g} s is not between two steps and the record", longest_s));
  const std::size_t n = frequency_hz.size();
  Ends ends{std::vector<double>(n), std::vector<double>(n)};
  for (std::size_t i = 0; i < n; ++i) {
    if (!std::isfinite(frequency_hz[i]) || frequency_hz[i] < 0.0)
      return Refuse(fmt::format("hull: the frequency of sample {} is {}", i, frequency_hz[i]));
    const double wanted = frequency_hz[i] > 0.0 ? periods / frequency_hz[i] : longest_s;
    const double window = std::clamp(wanted, shortest, longest_s);
    ends.from[i] = signal.time_s[i] - 0.5 * window;
    ends.to[i] = signal.time_s[i] + 0.5 * window;
  }
  for (std::size_t i = 1; i < n; ++i) ends.to[i] = std::max(ends.to[i], ends.to[i - 1]);
  for (std::size_t i = n - 1; i > 0; --i) ends.from[i - 1] = std::min(ends.from[i - 1], ends.from[i]);
  return HullWithin(signal, ends);
}

HullError CompareHulls(const HullCurve& reference, const HullCurve& test, const HullLimits& limits) {
  HullError error;
  error.global = error.local = std::numeric_limits<double>::quiet_NaN();
  if (!reference.ok() || !test.ok()) {
    const HullCurve& bad = reference.ok() ? test : reference;
    error.reason =
        fmt::format("{}: {}", reference.ok() ? "test" : "reference", bad.reason.empty() ? "no hull" : bad.reason);
    return error;
  }
  if (!(limits.global > 0.0) || !std::isfinite(limits.global) || !(limits.local >= 0.0) ||
      !std::isfinite(limits.local) || !(limits.significant > 0.0 && limits.significant <= 1.0)) {
    error.reason =
        "hull: the global limit must be positive, the local one not negative, the significant part in (0, 1]";
    return error;
  }
  const Aligned upper = AlignTo({reference.time_s, reference.upper}, {test.time_s, test.upper});
  const Aligned lower = AlignTo({reference.time_s, reference.lower}, {test.time_s, test.lower});
  error.reason = upper.reason.empty() ? lower.reason : upper.reason;
  if (!error.reason.empty()) return error;

  const std::size_t n = reference.time_s.size();
  for (std::size_t i = 0; i < n; ++i)
    error.largest_half_height = std::max(error.largest_half_height, 0.5 * (reference.upper[i] - reference.lower[i]));
  if (!(error.largest_half_height > 0.0)) {
    error.reason = "hull: the reference does not oscillate";
    return error;
  }
  error.global = error.local = 0.0;
  error.global_time_s = error.local_time_s = reference.time_s.front();
  for (std::size_t i = 0; i < n; ++i) {
    const double gap =
        std::max(std::abs(upper.test[i] - reference.upper[i]), std::abs(lower.test[i] - reference.lower[i]));
    const double half_height = 0.5 * (reference.upper[i] - reference.lower[i]);
    if (gap / error.largest_half_height > error.global) {
      error.global = gap / error.largest_half_height;
      error.global_time_s = reference.time_s[i];
    }
    const double significant = limits.significant * error.largest_half_height;
    if (half_height >= significant && gap / half_height > error.local) {  // NaN: AlignTo() has refused it
      error.local = gap / half_height;
      error.local_time_s = reference.time_s[i];
    }
  }
  if (!Within(error.global, limits.global)) {
    error.reason = fmt::format("hull off by {:.3g} % of the largest at {:.6g} s, {:.3g} % allowed",
                               100.0 * error.global, error.global_time_s, 100.0 * limits.global);
  } else if (limits.local > 0.0 && !Within(error.local, limits.local)) {
    error.reason = fmt::format("hull off by {:.3g} % of its own height at {:.6g} s, {:.3g} % allowed",
                               100.0 * error.local, error.local_time_s, 100.0 * limits.local);
  } else {
    error.verdict = Verdict::kPass;
  }
  return error;
}

Check HullCheck(const HullError& error, const HullLimits& limits, std::string name, std::string origin) {
  return ToCheck(error, std::move(name), "hull", error.global, limits.global, "of the largest hull", std::move(origin));
}

}  // namespace dynoproof::score
