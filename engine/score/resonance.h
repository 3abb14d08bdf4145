// The candidate of explain.h that a resonance differs. Internal to the layer.
#pragma once

#include "score/candidates.h"

namespace dynoproof::score {

/// One resonance moved or damped differently: test = k F(reference) with one pair of poles exchanged for another.
void AddResonance(const Pair& pair, Candidates& out);

}  // namespace dynoproof::score
