// Comparisons that decide. A comparison with NaN is false, so that `value > limit` lets it pass; ci/check_nan.py demands
// these wherever a limit is compared with.
#pragma once

#include <cmath>

namespace dynoproof {

/// Whether a value holds a limit from above. What is no finite number holds none, and no such limit is held.
inline bool Within(double value, double limit) {
  return std::isfinite(value) && std::isfinite(limit) && value <= limit;
}

/// Whether a value reaches what it must at least be; else as Within().
inline bool Reaches(double value, double least) { return Within(least, value); }

}  // namespace dynoproof
