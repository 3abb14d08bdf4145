#include "thesis/limit_cycle.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace dynoproof {
namespace {

constexpr double kMoves_Hz = 20.0;  // a resonance moves by 2 Hz with the gain; the next one is 200 Hz away

/// The amplitude with which the limit lets through a share below 1: N falls from 1 to 0.
double AmplitudeFor(double share) {
  double low = 1.0, high = 2.0 / share;  // N(a) < 4/(pi a)
  for (int halving = 0; halving < 60; ++halving) {
    const double middle = 0.5 * (low + high);
    (SaturationGain(middle) > share ? low : high) = middle;
  }
  return low;
}

}  // namespace

double SaturationGain(double a) {
  if (a <= 1.0) return 1.0;
  return 2.0 / std::numbers::pi * (std::asin(1.0 / a) + std::sqrt(1.0 - 1.0 / (a * a)) / a);
}

Result<LimitCycle> PredictLimitCycle(const std::function<Result<std::vector<FilteredLoopMode>>(double k_V)>& modes,
                                     double k_V, double near_Hz, double T_limit_Nm) {
  const auto mode_at = [&](double gain) -> Result<FilteredLoopMode> {
    const auto all = modes(gain);
    if (!all.ok()) return all.failure();
    const auto mode =
        std::ranges::find_if(*all, [=](const auto& one) { return std::abs(one.frequency_hz - near_Hz) < kMoves_Hz; });
    if (mode == all->end()) return Failure{"no mode lies near", "limit cycle", {}, 2};
    return *mode;
  };
  constexpr double kSteps = 40.0;  // of the gain: the bracket of the border, from the top
  double high = k_V, low = k_V;
  for (;; high = low, low -= k_V / kSteps) {
    if (low <= 0.0) return Failure{"the mode grows at every gain", "limit cycle", {}, 2};
    const Result<FilteredLoopMode> mode = mode_at(low);
    if (!mode.ok()) return mode.failure();
    if (mode->growth_per_s <= 0.0) break;
  }
  if (high == low) return Failure{"the mode does not grow at k_V", "limit cycle", {}, 2};
  while (high - low > 1e-7 * k_V) {
    const double middle = 0.5 * (low + high);
    const Result<FilteredLoopMode> mode = mode_at(middle);
    if (!mode.ok()) return mode.failure();
    (mode->growth_per_s > 0.0 ? high : low) = middle;
  }
  const Result<FilteredLoopMode> border = mode_at(low);
  if (!border.ok()) return border.failure();
  return LimitCycle{border->frequency_hz, AmplitudeFor(low / k_V) * T_limit_Nm / k_V, low};
}

}  // namespace dynoproof
