// Candidates from their first look through all levels, side by side.
#pragma once

#include <span>
#include <string>

#include "diagnosis/conduct.h"
#include "diagnosis/contestant.h"

namespace dynoproof::diagnosis {

/// Why a model is not fitted at a level that only leads to the exact minimum of the free run: it is far from the noise before, and
/// has no such minimum, or there already. Empty: it is fitted.
std::string SteppedOver(const Contestant& contestant, const Levels& levels, std::size_t level);

/// `contestants`: the null first, which is fitted at all levels already; each of the others holds at `first` or at the next
/// level. At each level all are fitted once more from the values of the one that leaves least, the null too. Nobody is
/// followed further who removes next to nothing where another removes most, or whom a model beats that leaves nothing but
/// noise. False where the conduct has ended it before the free run.
bool Carry(std::span<Contestant> contestants, const Levels& levels, std::size_t first, const Conduct& conduct);

}  // namespace dynoproof::diagnosis
