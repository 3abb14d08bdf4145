#include "score/series.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace dynoproof::score {
namespace {

constexpr double kLargest = 1e150;

}  // namespace

std::string FaultOf(const Series& series, std::string_view name, std::size_t min_samples) {
  const auto& [time, values, interpolation] = series;
  if (time.size() != values.size()) return fmt::format("{}: {} times but {} values", name, time.size(), values.size());
  if (time.empty()) return fmt::format("{}: no samples", name);
  if (time.size() < min_samples)
    return fmt::format("{}: {} samples, at least {} needed", name, time.size(), min_samples);
  for (std::size_t i = 0; i < time.size(); ++i) {
    if (!std::isfinite(time[i])) return fmt::format("{}: time of sample {} is {}", name, i, time[i]);
    if (!std::isfinite(values[i])) return fmt::format("{}: sample {} at {:.6g} s is {}", name, i, time[i], values[i]);
    if (std::abs(values[i]) > kLargest || std::abs(time[i]) > kLargest)
      return fmt::format("{}: sample {} at {:.6g} s is beyond 1e150", name, i, time[i]);
    if (i > 0 && !(time[i] > time[i - 1]))
      return fmt::format("{}: time does not rise at sample {} ({:.9g} s after {:.9g} s)", name, i, time[i],
                         time[i - 1]);
  }
  return {};
}

std::string UniformFault(std::span<const double> time_s, std::string_view name) {
  if (time_s.size() < 2) return fmt::format("{}: {} samples have no time step", name, time_s.size());
  const double mean_step = (time_s.back() - time_s.front()) / Num(time_s.size() - 1);
  for (std::size_t i = 1; i < time_s.size(); ++i) {
    const double step = time_s[i] - time_s[i - 1];
    if (!(std::abs(step - mean_step) <= 1e-3 * mean_step))
      return fmt::format("{}: time base is not uniform (step {:.6g} s at {:.6g} s, mean {:.6g} s)", name, step,
                         time_s[i - 1], mean_step);
  }
  return {};
}

bool IsJump(std::span<const double> time_s, std::size_t i) {
  constexpr double kUlps = 8.0;
  return time_s[i + 1] - time_s[i] <=
         kUlps * std::numeric_limits<double>::epsilon() * std::abs(time_s[i]) + std::numeric_limits<double>::min();
}

double MedianStep(std::span<const double> time_s) {
  std::vector<double> steps;
  steps.reserve(time_s.size());
  for (std::size_t i = 0; i + 1 < time_s.size(); ++i) {
    if (!IsJump(time_s, i)) steps.push_back(time_s[i + 1] - time_s[i]);
  }
  return steps.empty() ? time_s.back() - time_s.front() : Median(steps);
}

std::string CoverageFault(const Series& reference, const Series& test, double max_gap_s) {
  const double reference_step = MedianStep(reference.time_s);
  const double test_step = MedianStep(test.time_s);
  const double slack = 1e-3 * reference_step;
  const double first = reference.time_s.front();
  const double last = reference.time_s.back();
  if (test.time_s.front() > first + slack)
    return fmt::format("test starts late: at {:.9g} s, the reference at {:.9g} s", test.time_s.front(), first);
  const double held = test.interpolation == Interpolation::kHold ? test_step : 0.0;
  if (test.time_s.back() + held < last - slack)
    return fmt::format("test ends early: at {:.9g} s, the reference at {:.9g} s", test.time_s.back(), last);

  const double longest = max_gap_s > 0.0 ? max_gap_s : 3.0 * std::max(reference_step, test_step);
  std::size_t i = 0;
  for (std::size_t j = 1; j < test.time_s.size(); ++j) {
    const double from = test.time_s[j - 1];
    const double to = test.time_s[j];
    if (to - from <= longest) continue;
    while (i < reference.time_s.size() && reference.time_s[i] <= from + slack) ++i;
    if (i < reference.time_s.size() && reference.time_s[i] < to - slack)
      return fmt::format("test has a gap from {:.9g} s to {:.9g} s (longest step allowed {:.3g} s)", from, to, longest);
  }
  return {};
}

std::vector<double> SampleAt(const Series& series, std::span<const double> times_s) {
  const auto& [time, values, interpolation] = series;
  std::vector<double> out(times_s.size());
  std::size_t j = 0;  // time[j] <= t < time[j + 1]
  for (std::size_t i = 0; i < times_s.size(); ++i) {
    const double t = times_s[i];
    while (j + 1 < time.size() && time[j + 1] <= t) ++j;
    if (t <= time[j] || j + 1 == time.size()) {
      out[i] = values[j];
      continue;
    }
    const double part = (t - time[j]) / (time[j + 1] - time[j]);
    if (interpolation == Interpolation::kHold)
      out[i] = part > 1.0 - 1e-6 ? values[j + 1] : values[j];
    else
      out[i] = values[j] + part * (values[j + 1] - values[j]);
  }
  return out;
}

Aligned AlignTo(const Series& reference, const Series& test, double max_gap_s, std::size_t min_samples) {
  Aligned aligned;
  aligned.reason = FaultOf(reference, "reference", min_samples);
  if (aligned.reason.empty()) aligned.reason = FaultOf(test, "test", std::min<std::size_t>(min_samples, 2));
  if (aligned.reason.empty() && !std::isfinite(max_gap_s)) aligned.reason = "the longest gap allowed is not finite";
  if (aligned.reason.empty()) aligned.reason = CoverageFault(reference, test, max_gap_s);
  if (!aligned.reason.empty()) return aligned;
  aligned.test = SampleAt(test, reference.time_s);
  aligned.verdict = Verdict::kPass;
  return aligned;
}

double Mean(std::span<const double> values) {
  double sum = 0.0;
  for (double v : values) sum += v;
  return values.empty() ? 0.0 : sum / Num(values.size());
}

double RootMeanSquare(std::span<const double> values) {
  double sum = 0.0;
  for (double v : values) sum += v * v;
  return values.empty() ? 0.0 : std::sqrt(sum / Num(values.size()));
}

double StandardDeviation(std::span<const double> values) {
  const double mean = Mean(values);
  double sum = 0.0;
  for (double v : values) sum += (v - mean) * (v - mean);
  return values.empty() ? 0.0 : std::sqrt(sum / Num(values.size()));
}

double Median(std::span<const double> values) {
  if (values.empty()) return 0.0;
  std::vector<double> sorted(values.begin(), values.end());
  const auto middle = sorted.begin() + static_cast<std::ptrdiff_t>(sorted.size() / 2);
  std::nth_element(sorted.begin(), middle, sorted.end());
  if (sorted.size() % 2 == 1) return *middle;
  return 0.5 * (*middle + *std::max_element(sorted.begin(), middle));
}

double Largest(std::span<const double> values) {
  double largest = 0.0;
  for (double v : values) largest = std::max(largest, std::abs(v));
  return largest;
}

}  // namespace dynoproof::score
