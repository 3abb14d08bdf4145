#include "score/white_noise.h"

#include <cmath>
#include <cstddef>

#include "score/series.h"

namespace dynoproof::score {

double WhiteNoise(const std::vector<double>& values) {
  constexpr int kOrder = 6;
  constexpr double kGain = 30.397;            // sqrt(924): the sum of the squared binomial coefficients
  constexpr double kNormalMedian = 0.674490;  // of the magnitude of a normal deviate
  if (values.size() <= kOrder) return 0.0;
  std::vector<double> d = values;
  for (int order = 0; order < kOrder; ++order) {
    for (std::size_t i = 0; i + 1 < d.size(); ++i) d[i] = d[i + 1] - d[i];
    d.pop_back();
  }
  for (double& value : d) value = std::abs(value);
  return Median(d) / kGain / kNormalMedian;
}

}  // namespace dynoproof::score
