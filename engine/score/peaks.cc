#include "score/peaks.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "base/within.h"

namespace dynoproof::score {
namespace {

struct Extremum {
  std::size_t index = 0;
  bool maximum = true;
};

// Alternating maxima and minima of `level` that differ by `delta` at least. The first turn has nothing on its left to
// stand out against: it only sets the direction.
std::vector<Extremum> Alternating(std::span<const double> level, double delta) {
  std::vector<Extremum> out;
  std::size_t high = 0, low = 0;
  enum { kEither, kMaximum, kMinimum } seek = kEither;
  for (std::size_t i = 1; i < level.size(); ++i) {
    if (level[i] > level[high]) high = i;
    if (level[i] < level[low]) low = i;
    if (seek != kMinimum && level[i] <= level[high] - delta) {
      if (seek == kMaximum) out.push_back({high, true});
      seek = kMinimum;
      low = high = i;
    } else if (seek != kMaximum && level[i] >= level[low] + delta) {
      if (seek == kMinimum) out.push_back({low, false});
      seek = kMaximum;
      low = high = i;
    }
  }
  return out;
}

// Frequency at which `level` crosses `target` on the way from `peak` towards `end`, or none before it.
std::optional<double> Crossing(std::span<const double> f, std::span<const double> level, std::size_t peak,
                               std::size_t end, double target, double sign) {
  const std::ptrdiff_t step = end > peak ? 1 : -1;
  for (std::size_t i = peak; i != end; i += step) {
    const std::size_t next = i + step;
    if (sign * level[next] > sign * target) continue;
    const double part = (target - level[i]) / (level[next] - level[i]);
    return f[i] + std::clamp(part, 0.0, 1.0) * (f[next] - f[i]);
  }
  return std::nullopt;
}

double RelativeError(double found, double expected) { return std::abs(found - expected) / std::abs(expected); }

std::string NameOf(const Peak& peak) {
  return fmt::format("{} at {:.5g} Hz", peak.kind == PeakKind::kResonance ? "resonance" : "anti-resonance",
                     peak.frequency_hz);
}

std::string LimitFault(std::span<const ExpectedPeak> expected, const PeakLimits& limits) {
  if (expected.empty()) return "peaks: nothing is expected, so nothing was compared";
  if (!(limits.frequency > 0.0) || !std::isfinite(limits.frequency))
    return "peaks: the frequency limit must be positive";
  if (!(limits.search > 0.0) || !std::isfinite(limits.search)) return "peaks: the search range must be positive";
  for (const ExpectedPeak& peak : expected) {
    if (!(peak.frequency_hz > 0.0) || !std::isfinite(peak.frequency_hz))
      return fmt::format("peaks: an expected frequency is {}", peak.frequency_hz);
    const bool height_ok = !peak.height || (*peak.height > 0.0 && std::isfinite(*peak.height));
    const bool damping_ok = !peak.damping_ratio || (*peak.damping_ratio > 0.0 && std::isfinite(*peak.damping_ratio));
    if (!height_ok || !damping_ok) return "peaks: expected heights and damping ratios must be positive";
    if ((peak.height && !(limits.height > 0.0 && std::isfinite(limits.height))) ||
        (peak.damping_ratio && !(limits.damping > 0.0 && std::isfinite(limits.damping))))
      return "peaks: an expected height or damping has no limit";
  }
  return {};
}

// Judges one pair; returns the worst error over its limit.
double Judge(PeakMatch& match, const PeakLimits& limits) {
  const Peak& found = *match.found;
  const ExpectedPeak& expected = match.expected;
  double worst = RelativeError(found.frequency_hz, expected.frequency_hz) / limits.frequency;
  const auto add = [&](std::string text) { match.fault += (match.fault.empty() ? "" : ", ") + std::move(text); };
  if (!(worst <= 1.0))  // written so that NaN is a fault
    add(fmt::format("moved from {:.5g} to {:.5g} Hz ({:+.2f} %, {:.2g} % allowed)", expected.frequency_hz,
                    found.frequency_hz, 100.0 * (found.frequency_hz / expected.frequency_hz - 1.0),
                    100.0 * limits.frequency));
  if (expected.height) {
    const double ratio = RelativeError(found.height, *expected.height) / limits.height;
    if (!(ratio <= 1.0))
      add(fmt::format("height {:.4g} instead of {:.4g} ({:.2g} % allowed)", found.height, *expected.height,
                      100.0 * limits.height));
    worst = std::max(ratio, worst);
  }
  if (expected.damping_ratio) {
    const double ratio = found.damping_ratio
                             ? RelativeError(*found.damping_ratio, *expected.damping_ratio) / limits.damping
                             : std::numeric_limits<double>::infinity();
    if (!found.damping_ratio)
      add("its damping cannot be read off");
    else if (!(ratio <= 1.0))
      add(fmt::format("damping ratio {:.4g} instead of {:.4g} ({:.2g} % allowed)", *found.damping_ratio,
                      *expected.damping_ratio, 100.0 * limits.damping));
    worst = std::max(worst, ratio);
  }
  return worst;
}

}  // namespace

PeakList FindPeaks(std::span<const double> frequency_hz, std::span<const double> amplitude, double prominence_db) {
  PeakList out;
  out.reason = FaultOf({frequency_hz, amplitude}, "amplitude response", 8);
  if (out.reason.empty() && (!(prominence_db > 0.0) || !std::isfinite(prominence_db)))
    out.reason = "peaks: the prominence must be positive";
  if (out.reason.empty() && frequency_hz.front() < 0.0) out.reason = "peaks: a frequency is negative";
  std::vector<double> level(amplitude.size());
  for (std::size_t i = 0; i < amplitude.size() && out.reason.empty(); ++i) {
    level[i] = 20.0 * std::log10(amplitude[i]);
    if (!std::isfinite(level[i]))
      out.reason = fmt::format("peaks: the amplitude at {:.6g} Hz is not positive", frequency_hz[i]);
  }
  if (!out.reason.empty()) return out;

  const std::vector<Extremum> extrema = Alternating(level, prominence_db);
  const double half_power_db = 10.0 * std::log10(2.0);
  for (std::size_t e = 0; e < extrema.size(); ++e) {
    const auto [i, maximum] = extrema[e];
    const double sign = maximum ? 1.0 : -1.0;
    // Parabola through three points with uneven steps.
    const double h1 = frequency_hz[i - 1] - frequency_hz[i], h2 = frequency_hz[i + 1] - frequency_hz[i];
    const double s1 = (level[i - 1] - level[i]) / h1, s2 = (level[i + 1] - level[i]) / h2;
    const double curvature = (s2 - s1) / (h2 - h1), slope = s1 - curvature * h1;
    const double shift = sign * curvature < 0.0 ? std::clamp(-0.5 * slope / curvature, h1, h2) : 0.0;
    const double top = level[i] + shift * (slope + curvature * shift);

    Peak peak{maximum ? PeakKind::kResonance : PeakKind::kAntiResonance,
              frequency_hz[i] + shift,
              std::pow(10.0, top / 20.0),
              {}};
    const double target = top - sign * half_power_db;
    const std::size_t left_end = e > 0 ? extrema[e - 1].index : 0;
    const std::size_t right_end = e + 1 < extrema.size() ? extrema[e + 1].index : level.size() - 1;
    const auto f1 = Crossing(frequency_hz, level, i, left_end, target, sign);
    const auto f2 = Crossing(frequency_hz, level, i, right_end, target, sign);
    const double f0 = peak.frequency_hz;
    if (f1 || f2) {
      const double below = f1 ? f0 * f0 - *f1 * *f1 : *f2 * *f2 - f0 * f0;
      const double above = f2 ? *f2 * *f2 - f0 * f0 : below;
      peak.damping_ratio = (below + above) / (4.0 * f0 * f0);
    }
    out.peaks.push_back(peak);
  }
  out.verdict = Verdict::kPass;
  return out;
}

PeakComparison ComparePeaks(const PeakList& found, std::span<const ExpectedPeak> expected, const PeakLimits& limits) {
  PeakComparison out;
  out.worst = std::numeric_limits<double>::quiet_NaN();
  out.reason = LimitFault(expected, limits);
  if (out.reason.empty() && !found.ok()) out.reason = found.reason.empty() ? "peaks: no list" : found.reason;
  if (!out.reason.empty()) return out;

  struct Pair {
    double distance = 0.0;
    std::size_t expected = 0, found = 0;
  };
  std::vector<Pair> pairs;
  for (std::size_t i = 0; i < expected.size(); ++i) {
    out.matches.push_back({expected[i], std::nullopt, {}});
    for (std::size_t j = 0; j < found.peaks.size(); ++j) {
      const double distance = RelativeError(found.peaks[j].frequency_hz, expected[i].frequency_hz);
      if (found.peaks[j].kind == expected[i].kind && Within(distance, limits.search)) pairs.push_back({distance, i, j});
    }
  }
  std::sort(pairs.begin(), pairs.end(), [](const Pair& a, const Pair& b) { return a.distance < b.distance; });
  std::vector<bool> used(found.peaks.size(), false);
  for (const Pair& pair : pairs) {
    if (used[pair.found] || out.matches[pair.expected].found) continue;
    used[pair.found] = true;
    out.matches[pair.expected].found = found.peaks[pair.found];
  }

  out.worst = 0.0;
  const auto blame = [&](const std::string& text) { out.reason += (out.reason.empty() ? "" : "; ") + text; };
  for (PeakMatch& match : out.matches) {
    const Peak as_peak{match.expected.kind, match.expected.frequency_hz, 0.0, {}};
    if (!match.found) {
      match.fault = "missing";
      out.worst = std::numeric_limits<double>::infinity();
    } else {
      out.worst = std::max(out.worst, Judge(match, limits));
    }
    if (!match.fault.empty()) blame(NameOf(as_peak) + ": " + match.fault);
  }
  for (std::size_t j = 0; j < found.peaks.size(); ++j) {
    if (used[j]) continue;
    out.extra.push_back(found.peaks[j]);
    if (limits.extra_allowed) continue;
    out.worst = std::numeric_limits<double>::infinity();
    blame(NameOf(found.peaks[j]) + ": not expected");
  }
  if (out.reason.empty()) out.verdict = Verdict::kPass;
  return out;
}

}  // namespace dynoproof::score
