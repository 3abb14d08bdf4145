// Pairs of effects, for records that one effect does not account for. The effect that removes most alone may stand for two
// others, as a bent characteristic does for a limit and an offset, and a search that goes on from it never comes to these.
#pragma once

#include <optional>
#include <vector>

#include "diagnosis/contest.h"
#include "diagnosis/settle.h"

namespace dynoproof::diagnosis {

struct Base {
  std::size_t contestant;
  Contestant pair;  // with the second effect that leaves least beside it, fitted cheaply at one level
  std::size_t level;

  const estimation::Estimate& fit() const { return pair.levels[level]; }
};

/// Tries each contestant that removes a fifth of the null's excess (at most policy::kBases of them) together with the effects that removed a
/// twentieth at the first look, at the longest memory within the record. Gives the best pair of each, and that first which
/// leaves least: in the free run, to which those are carried that noise hides from one another at that memory. Empty where the null or
/// no contestant holds there.
std::vector<Base> BasesOfPairs(const Contest& contest, const Levels& levels, const Magnitudes& magnitudes,
                               const Registry& registry, const Conduct& conduct);

/// The contestant on top of which a further cause is looked for: the cause that was found, or the effect that explains most; but a half
/// of the first pair, where that leaves less than the leader does with any second effect, and of its halves the one that most pairs
/// have which leave as little. Under the priors the leader, its best pair, or without a leader the first of all pairs has to be near
/// the noise. Nothing: on top of none.
std::optional<std::size_t> BaseOf(const Contest& contest, const Settled& settled, const std::vector<Base>& bases,
                                  const Levels& levels, Journal& journal);

}  // namespace dynoproof::diagnosis
