#include "identification/finite_difference.h"

#include <algorithm>
#include <cmath>

namespace dynoproof::identification {

bool NeedsWideDifferences(const std::vector<EffectInstance>& effects) {
  return std::any_of(effects.begin(), effects.end(),
                     [](const EffectInstance& one) { return one.effect->info().traits.dry_friction; });
}

std::optional<Difference> DifferenceOf(const std::function<Result<Eigen::VectorXd>(double)>& predicted,
                                       const Eigen::VectorXd& here, const Whitener& whitener, double step, bool wide,
                                       double most) {
  constexpr double kAim = 2.0, kTooSmall = 1.0, kTooLarge = 6.0;  // standard deviations
  constexpr int kTries = 6;
  const double least = step;
  Difference difference;
  for (int k = 0; k < kTries; ++k) {
    Result<Eigen::VectorXd> there = predicted(step);
    ++difference.simulations;
    if (!there.ok() || !there->allFinite()) {
      if (difference.step == 0.0) return std::nullopt;
      break;  // the smaller one stands
    }
    difference.change = *there - here;
    difference.step = step;
    if (!wide) break;
    const double size = whitener(difference.change).norm();
    if (size > kTooSmall && size < kTooLarge) break;
    const double wanted = step * std::clamp(kAim / std::max(size, 1e-300), 1e-2, 1e3);
    const double next = std::copysign(std::clamp(std::abs(wanted), std::abs(least), most * std::abs(least)), least);
    if (next == step) break;
    step = next;
  }
  return difference;
}

}  // namespace dynoproof::identification
