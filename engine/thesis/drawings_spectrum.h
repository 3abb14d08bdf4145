// Drawings of the frequency estimation, Secs. 5.4.1 and 5.4.2: two band-passes, and a tone between two bins.
#pragma once

#include "thesis/drawings.h"

namespace dynoproof {

DrawingTable SpectrumDrawings();

}  // namespace dynoproof
