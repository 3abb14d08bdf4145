// Effects whose columns say the same as those of the best model, beside which nominal values follow: at a strong correction, where the
// candidates are chosen that are carried, they may look unlike, and one that was not carried would be no rival.
#pragma once

#include "diagnosis/contest.h"
#include "diagnosis/sketch.h"

namespace dynoproof::diagnosis {

/// Takes those of the first look that were left behind and whose columns at this level, all else following, lie along those of the
/// best model's last effect (cosine of at least policy::kAlike), into a contest, fitted at this level alone. They begin at what the best
/// model has come to, the effect at the size at which it does what that one's effect does. Nothing where the null is the best, or no rows
/// of the best are kept. By one run for each that was left behind, and a fit for each twin.
void CarryTwins(Contest& contest, const Levels& levels, std::size_t level, const Magnitudes& magnitudes);

/// The same of the effects on top of which a contest was asked, by those of the contest before. `nominal`: the hypothesis without effects.
/// Whether there are any.
bool CarryTwinsOfBase(Contest& contest, const Contest& before, const estimation::Hypothesis& nominal,
                      const Levels& levels, std::size_t level, const Magnitudes& magnitudes);

}  // namespace dynoproof::diagnosis
