// What a record would have shown: of each effect the smallest strength that would have been told from the nominal model.
#pragma once

#include <vector>

#include "diagnosis/contestant.h"
#include "diagnosis/diagnose.h"
#include "diagnosis/trial.h"

namespace dynoproof::diagnosis {

/// Deviations of an effect's column, weighted by the noise, from which on it is named: as many as a weight has to lie below 0.9
/// (estimation::Compare()).
inline constexpr double kSeenDeviations = 4.0 / 0.9;

/// How large a candidate may be without being one: of a nominal value what lies within its prior [of the value]; else 0.
double WithinItsPrior(const Trial& trial, const estimation::Hypothesis& null);

/// In the free run, at which the null holds and leaves nothing but noise. From runs at about that size; what the nominal values
/// make up for within their bounds does not show. Effects without a strength, and those that change nothing, are left
/// out. `magnitudes`: of the first record.
std::vector<Seen> SmallestSeen(const Contestant& null, const Levels& levels, const Magnitudes& magnitudes,
                               const Registry& registry);

}  // namespace dynoproof::diagnosis
