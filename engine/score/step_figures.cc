#include "score/step_figures.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

namespace dynoproof::score {
namespace {

constexpr double kMadToSigma = 1.4826;     // of a normal distribution
constexpr double kAllowance = 1.6;         // sigma; 3 sqrt(pi / (2 * 5)), see the header
constexpr double kNegligibleNoise = 1e-3;  // of the step

double NoiseSigma(std::span<const double> values) {
  std::vector<double> steps;
  for (std::size_t i = 1; i < values.size(); ++i) steps.push_back(values[i] - values[i - 1]);
  const double middle = Median(steps);  // a slope is no noise
  for (double& s : steps) s = std::abs(s - middle);
  return kMadToSigma * Median(steps) / std::sqrt(2.0);
}

std::vector<double> MedianOfFive(std::span<const double> values) {
  std::vector<double> out(values.begin(), values.end());
  for (std::size_t i = 2; i + 2 < values.size(); ++i) {
    std::array<double, 5> near;
    std::copy_n(values.begin() + static_cast<std::ptrdiff_t>(i) - 2, 5, near.begin());
    std::nth_element(near.begin(), near.begin() + 2, near.end());
    out[i] = near[2];
  }
  if (values.size() >= 5) {  // the ends have no five samples; a lone outlier there must not count either
    out[0] = out[1] = out[2];
    out[values.size() - 1] = out[values.size() - 2] = out[values.size() - 3];
  }
  return out;
}

// First time at which `level` of the normalised response is reached, linear between samples.
double CrossingTime(std::span<const double> time, std::span<const double> y, double level) {
  for (std::size_t i = 0; i < y.size(); ++i) {
    if (y[i] < level) continue;
    if (i == 0) return time[0];
    return time[i - 1] + (time[i] - time[i - 1]) * (level - y[i - 1]) / (y[i] - y[i - 1]);
  }
  return std::numeric_limits<double>::quiet_NaN();
}

// When |y - 1| last came down to `band`, linear between samples.
double EntryTime(std::span<const double> time, std::span<const double> y, double band) {
  for (std::size_t i = y.size(); i-- > 0;) {
    const double error = std::abs(y[i] - 1.0);
    if (error <= band) continue;
    if (i + 1 == y.size()) return std::numeric_limits<double>::infinity();
    const double next = (y[i] > 1.0 ? y[i + 1] - 1.0 : 1.0 - y[i + 1]);  // signed: it may cross the whole band
    return time[i] + (time[i + 1] - time[i]) * (error - band) / (error - next);
  }
  return time.front();
}

}  // namespace

StepFigures AnalyseStep(const Series& response, const StepOptions& options) {
  StepFigures out;
  out.reason = FaultOf(response, "response", 20);
  if (!out.reason.empty()) return out;
  const auto time = response.time_s;
  const bool sound = options.settling_band > 0.0 && options.settling_band < 1.0 && options.final_part > 0.0 &&
                     options.final_part < 1.0 && (!options.start || std::isfinite(*options.start)) &&
                     (!options.target || std::isfinite(*options.target));
  if (!sound) {
    out.reason = "step: band and final part must lie between 0 and 1, start and target must be finite";
    return out;
  }
  if (!(options.step_time_s >= time.front() && options.step_time_s < time.back())) {
    out.reason = fmt::format("step: its time {:.6g} s lies outside the record", options.step_time_s);
    return out;
  }
  // The sample at the step itself still shows the level before it.
  const auto first =
      static_cast<std::size_t>(std::upper_bound(time.begin(), time.end(), options.step_time_s) - time.begin());
  const auto after = time.subspan(first - 1);
  const auto values = response.values.subspan(first - 1);
  const double final_time = time.back() - options.final_part * (time.back() - options.step_time_s);
  const auto last_part = values.subspan(
      static_cast<std::size_t>(std::lower_bound(after.begin(), after.end(), final_time) - after.begin()));
  if (after.size() < 20 || last_part.size() < 3) {
    out.reason =
        fmt::format("step: {} samples after it, {} in the last part; 20 and 3 needed", after.size(), last_part.size());
    return out;
  }
  out.start = options.start.value_or(Median(response.values.first(first)));
  out.steady = Median(last_part);
  out.step = out.steady - out.start;
  out.noise_sigma = NoiseSigma(last_part);
  if (options.target) out.steady_error = out.steady - *options.target;
  const double round_off = 64.0 * std::numeric_limits<double>::epsilon() * (std::abs(out.start) + std::abs(out.steady));
  if (!(std::abs(out.step) > std::max(6.0 * out.noise_sigma, round_off))) {
    out.reason = fmt::format("no step: the level changes by {:.4g} with noise of {:.4g}", out.step, out.noise_sigma);
    return out;
  }

  // From here on y goes from 0 to 1, whatever the sign of the step.
  std::vector<double> y(values.begin(), values.end());
  const double sigma = out.noise_sigma / std::abs(out.step);
  const bool noisy = sigma > kNegligibleNoise;
  if (noisy) y = MedianOfFive(y);
  for (double& v : y) v = (v - out.start) / out.step;
  const double allowance = noisy ? kAllowance * sigma : 0.0;
  const auto highest = std::max_element(y.begin(), y.end());
  out.overshoot_percent = 100.0 * std::max(0.0, *highest - 1.0 - allowance);
  out.undershoot_percent = 100.0 * std::max(0.0, -*std::min_element(y.begin(), y.end()) - allowance);
  out.peak_time_s = after[highest - y.begin()] - options.step_time_s;
  out.rise_time_s = CrossingTime(after, y, 0.9) - CrossingTime(after, y, 0.1);
  const double settled = EntryTime(after, y, options.settling_band + allowance);
  if (!(settled <= final_time)) {
    out.settling_time_s = std::numeric_limits<double>::quiet_NaN();
    out.reason = fmt::format("step: not settled within {:.3g} % by {:.6g} s, where the last part of the record starts",
                             100.0 * options.settling_band, final_time);
    return out;
  }
  out.settling_time_s = std::max(0.0, settled - options.step_time_s);
  if (!std::isfinite(out.rise_time_s)) {
    out.reason = "step: the response never crosses 10 % and 90 %";
    return out;
  }
  out.verdict = Verdict::kPass;
  return out;
}

RampFigures AnalyseRamp(const Series& command, const Series& response, const RampOptions& options) {
  RampFigures out;
  out.reason = FaultOf(command, "command", 20);
  if (out.reason.empty()) out.reason = FaultOf(response, "response", 20);
  if (!out.reason.empty()) return out;
  if (!(options.to_s > options.from_s) || !std::isfinite(options.to_s - options.from_s) ||
      !(options.settled_part > 0.0 && options.settled_part <= 1.0)) {
    out.reason = "ramp: it must end after it starts, and the settled part must lie in (0, 1]";
    return out;
  }
  const double slack = 1e-3 * MedianStep(command.time_s);
  const auto begin = std::lower_bound(command.time_s.begin(), command.time_s.end(), options.from_s - slack);
  const auto end = std::upper_bound(command.time_s.begin(), command.time_s.end(), options.to_s + slack);
  const auto first = static_cast<std::size_t>(begin - command.time_s.begin());
  const auto count = static_cast<std::size_t>(std::max<std::ptrdiff_t>(0, end - begin));
  if (command.time_s.front() > options.from_s + slack || command.time_s.back() < options.to_s - slack || count < 20) {
    out.reason = fmt::format("ramp: {} samples of the command lie within it, or it is not covered", count);
    return out;
  }
  const Series ramp{command.time_s.subspan(first, count), command.values.subspan(first, count), command.interpolation};
  const Aligned aligned = AlignTo(ramp, response);
  out.reason = aligned.reason;
  if (!out.reason.empty()) return out;

  const std::size_t settled = static_cast<std::size_t>(Num(count) * (1.0 - options.settled_part));
  std::vector<double> error(count);
  for (std::size_t i = 0; i < count; ++i) error[i] = ramp.values[i] - aligned.test[i];
  const auto steady = std::span<const double>(error).subspan(settled);
  const auto slope = [&](std::span<const double> v) {
    const auto t = ramp.time_s.subspan(settled);
    const double t_mean = Mean(t), v_mean = Mean(v);
    double tt = 0.0, tv = 0.0;
    for (std::size_t i = 0; i < v.size(); ++i) {
      tt += (t[i] - t_mean) * (t[i] - t_mean);
      tv += (t[i] - t_mean) * (v[i] - v_mean);
    }
    return tt > 0.0 ? tv / tt : 0.0;
  };
  out.command_slope = slope(ramp.values.subspan(settled));
  out.response_slope = slope(std::span<const double>(aligned.test).subspan(settled));
  out.steady_error = Median(steady);
  out.noise_sigma = NoiseSigma(error);
  const double travel = std::abs(out.command_slope) * (options.to_s - options.from_s);
  if (!(travel > 1e-12 * Largest(ramp.values)) || steady.size() < 3) {
    out.reason = "ramp: the command does not move";
    return out;
  }
  out.delay_s = out.steady_error / out.command_slope;
  const bool noisy = out.noise_sigma > kNegligibleNoise * travel;
  if (noisy) error = MedianOfFive(error);
  for (std::size_t i = 0; i < count; ++i) {
    const double size = std::max(0.0, std::abs(error[i]) - (noisy ? kAllowance * out.noise_sigma : 0.0));
    if (size <= out.largest_error) continue;
    out.largest_error = size;
    out.largest_error_time_s = ramp.time_s[i];
  }
  out.verdict = Verdict::kPass;
  return out;
}

}  // namespace dynoproof::score
