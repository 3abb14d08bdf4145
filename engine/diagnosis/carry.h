// Candidates from their first look through all levels, side by side.
#pragma once

#include <span>

#include "diagnosis/conduct.h"
#include "diagnosis/contestant.h"

namespace dynoproof::diagnosis {

/// `contestants`: the null first, which is fitted at every level already; each of the others holds at `first` or at the next
/// level. At each level all are fitted once more from the values of the one that leaves least, the null too. Nobody is
/// followed further who removes next to nothing where another removes most, or whom a model beats that leaves nothing but
/// noise. False where the conduct has ended it before the free run.
bool Carry(std::span<Contestant> contestants, const Levels& levels, std::size_t first, const Conduct& conduct);

}  // namespace dynoproof::diagnosis
