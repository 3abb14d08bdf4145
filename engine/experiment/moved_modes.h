// The eigenfrequencies that a changed number has moved, as a cause of a failed comparison with a golden trace.
#pragma once

#include <string>

#include "experiment/golden_place.h"
#include "experiment/prepare.h"

namespace dynoproof {

/// "modes moved from 604.97 to 598.97 Hz, from 832.7 to 824 Hz": undamped, of the scenario as it was when its golden trace was
/// blessed, and as it is. Empty where none moved, the number of modes changed, or the plant is no linear drive line.
std::string MovedModes(const Prepared& prepared);

}  // namespace dynoproof
