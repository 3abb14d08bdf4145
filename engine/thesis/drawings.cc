#include "thesis/drawings.h"

#include "thesis/drawings_loop.h"
#include "thesis/drawings_rotor.h"

namespace dynoproof {

const DrawingTable& Drawings() {
  static const DrawingTable all = [] {
    DrawingTable merged = RotorDrawings();
    merged.merge(LoopDrawings());
    return merged;
  }();
  return all;
}

}  // namespace dynoproof
