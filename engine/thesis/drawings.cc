#include "thesis/drawings.h"

#include "thesis/drawings_loop.h"
#include "thesis/drawings_rotor.h"
#include "thesis/drawings_spectrum.h"

namespace dynoproof {

const DrawingTable& Drawings() {
  static const DrawingTable all = [] {
    DrawingTable merged = RotorDrawings();
    merged.merge(LoopDrawings());
    merged.merge(SpectrumDrawings());
    return merged;
  }();
  return all;
}

}  // namespace dynoproof
