#include "model/effect_size.h"

#include <algorithm>
#include <cmath>

namespace dynoproof {

std::vector<std::size_t> StrengthsOf(const EffectInfo& effect) {
  std::vector<std::size_t> strengths;
  for (std::size_t i = 0; i < effect.parameters.size(); ++i) {
    const EffectParameter& parameter = effect.parameters[i];
    if (std::isfinite(parameter.neutral) && parameter.neutral < parameter.upper) strengths.push_back(i);
  }
  return strengths;
}

std::vector<std::size_t> SizedWith(const EffectInfo& effect) {
  const std::vector<std::size_t> strengths = StrengthsOf(effect);
  std::vector<std::size_t> sized = strengths;
  const std::vector<EffectParameter>& all = effect.parameters;
  for (std::size_t i = 0; i < all.size(); ++i) {
    const bool by = std::ranges::any_of(
        strengths, [&](std::size_t k) { return k != i && all[i].unit.starts_with(all[k].unit + "/"); });
    if (by && std::ranges::find(sized, i) == sized.end()) sized.push_back(i);
  }
  return sized;
}

}  // namespace dynoproof
