// Several numbers of a model may be wrong at once. Alone each explains little, so that a search of one cause after the other goes astray:
// of three inertias a tenth off it named a gain. All numbers let go together tell at once whether that is all.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "diagnosis/contest.h"

namespace dynoproof::diagnosis {

/// A contestant that leaves nothing but noise in the free run by its nominal values alone, let go: `released`, or what a thorough
/// search finds where that has come far from `null`, the model under its priors. Each step of it has columns of its own. Nothing where there is none.
std::optional<Contestant> ByNumbersAlone(const Contestant& null, const Contestant& released, const Levels& levels);

/// The numbers that such a model has farther from their priors than these allow, by the priors of `null`; the farthest first
/// [standard deviations].
std::vector<std::pair<std::string, double>> FarFromPriors(const Contestant& exact, const Contestant& null,
                                                          const Levels& levels);

/// A contest of the changes of such numbers (inertia_change, stiffness_change, ...), one to `most` at once, all else under its priors:
/// of the smallest sets of which one leaves nothing but noise all that do. Its first contestant alone: no set does.
Contest CompeteByChanges(const Contest& under_priors, const Contestant& exact, const Levels& levels,
                         const Magnitudes& magnitudes, const Registry& registry, std::size_t most);

}  // namespace dynoproof::diagnosis
