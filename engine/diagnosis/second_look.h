// Pairs of effects, for records that one effect does not account for. The effect that removes most alone may stand for two
// others, as a bent characteristic does for a limit and an offset, and a search that goes on from it never comes to these.
#pragma once

#include <vector>

#include "diagnosis/contest.h"

namespace dynoproof::diagnosis {

struct Base {
  std::size_t contestant;
  Contestant pair;  // with the second effect that leaves least beside it, fitted cheaply at one level
  std::size_t level;

  const estimation::Estimate& fit() const { return pair.levels[level]; }
};

/// Tries each contestant that removes a fifth of the null's excess (at most policy::kBases of them) together with the effects that removed a
/// twentieth at the first look, at the longest memory within the record. Gives the best pair of each, and that first which
/// leaves least. Empty where the null or no contestant holds there.
std::vector<Base> BasesOfPairs(const Contest& contest, const Levels& levels, const Magnitudes& magnitudes,
                               const Registry& registry, const Conduct& conduct);

}  // namespace dynoproof::diagnosis
