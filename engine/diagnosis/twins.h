// Twins: effects that move the outputs as one of the best model does, once its other numbers follow. Candidates are chosen at a strong
// correction, where twins may look unlike: a twin that was not carried would be missing among the rivals.
#pragma once

#include "diagnosis/contest.h"
#include "diagnosis/sketch.h"

namespace dynoproof::diagnosis {

/// Adds to a contest the twins of the best model's last effect, of those that the first look has left behind. An effect is a twin where its
/// column at this level lies along those of the other one (cosine of at least policy::kAlike), all other numbers following. Its fit begins at
/// the best model's values, with the size at which it does what the other one does, and is made at this level alone. Nothing is added where
/// the null is the best, or where the rows of the best were dropped. Takes one run for each that was left behind, and a fit for each twin.
void CarryTwins(Contest& contest, const Levels& levels, std::size_t level, const Magnitudes& magnitudes);

/// The same for the effects of the null on top of which a contest was asked; candidates are those of the contest before. `nominal`: the
/// hypothesis without effects. Returns whether there are any.
bool CarryTwinsOfBase(Contest& contest, const Contest& before, const estimation::Hypothesis& nominal,
                      const Levels& levels, std::size_t level, const Magnitudes& magnitudes);

}  // namespace dynoproof::diagnosis
