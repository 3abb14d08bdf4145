// What a record would have shown: of each effect the smallest strength that would have been told from the nominal model.
#pragma once

#include <vector>

#include "diagnosis/contestant.h"
#include "diagnosis/diagnose.h"
#include "diagnosis/trial.h"

namespace dynoproof::diagnosis {

/// In the free run, at which the null holds and leaves nothing but noise. From runs at about that size; what the nominal values
/// make up for within their bounds does not show. Effects without a strength, and those that change nothing, are left
/// out. `magnitudes`: of the first record.
std::vector<Seen> SmallestSeen(const Contestant& null, const Levels& levels, const Magnitudes& magnitudes,
                               const Registry& registry);

}  // namespace dynoproof::diagnosis
