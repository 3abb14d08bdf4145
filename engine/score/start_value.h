// The candidate of explain.h that the two runs start differently. Internal to the layer.
#pragma once

#include <string>

#include "score/candidates.h"

namespace dynoproof::score {

/// A difference that decays from the start: an exponential, or up to three ringing modes.
void AddStartValue(const Pair& pair, const std::string& unit, Candidates& out);

}  // namespace dynoproof::score
