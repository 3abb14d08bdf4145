// Drawings of the loop of chapter 5 and its filters: Figs. 5.2, 5.3, D.1, E.1.
#pragma once

#include "thesis/drawings.h"

namespace dynoproof {

DrawingTable LoopDrawings();

}  // namespace dynoproof
