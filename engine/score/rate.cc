#include "score/rate.h"

#include <algorithm>
#include <cmath>

namespace dynoproof::score {

double Rate::Wilson(double sign) const {
  if (of == 0) return sign < 0.0 ? 0.0 : 1.0;
  const double z = 1.96, n = static_cast<double>(of), p = value();
  const double bound =
      (p + z * z / (2 * n) + sign * z * std::sqrt(p * (1 - p) / n + z * z / (4 * n * n))) / (1 + z * z / n);
  return std::clamp(bound, 0.0, 1.0);  // round-off at 0 and 1
}

}  // namespace dynoproof::score
