// Drawings of chains and rotors: Figs. 2.14, 2.30, B.2.
#pragma once

#include "thesis/drawings.h"

namespace dynoproof {

DrawingTable RotorDrawings();

}  // namespace dynoproof
