#include "score/white_noise.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <cstddef>
#include <limits>
#include <numeric>

#include "score/fft.h"
#include "score/series.h"
#include "score/spectrum.h"

namespace dynoproof::score {

namespace {

/// By the median of the sixth differences.
double ByDifferences(const std::vector<double>& values) {
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

/// Power a sample of the quietest eighth of the frequencies up to half the sampling rate, windowed so that no slow motion leaks there.
double QuietestPower(const std::vector<double>& values) {
  constexpr std::size_t kBands = 8;
  const std::vector<double> weights = WindowWeights(Window::kBlackman, values.size());
  const double mean = std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
  std::vector<double> windowed(values.size());
  double weight = 0.0;
  for (std::size_t i = 0; i < values.size(); ++i) {
    windowed[i] = weights[i] * (values[i] - mean);
    weight += weights[i] * weights[i];
  }
  const std::vector<std::complex<double>> spectrum = Fft(windowed);
  const std::size_t bins = values.size() / 2 / kBands;
  double quietest = std::numeric_limits<double>::infinity();
  for (std::size_t band = 0; band < kBands; ++band) {
    double sum = 0.0;
    for (std::size_t k = band * bins; k < (band + 1) * bins; ++k) sum += std::norm(spectrum[k]);
    quietest = std::min(quietest, sum / static_cast<double>(bins) / weight);
  }
  return quietest;
}

}  // namespace

double WhiteNoise(const std::vector<double>& values) {
  // 125 bins a band, of which the window makes 72 that do not hang together: their mean scatters by an eighth, the least of
  // eight lies a sixth below. Half the power is four deviations away.
  constexpr std::size_t kEnough = 2000;
  constexpr double kSeesMore = 0.5;
  const double differences = ByDifferences(values);
  if (values.size() < kEnough || !(differences > 0.0)) return differences;
  const double quietest = QuietestPower(values);
  return quietest < kSeesMore * differences * differences ? std::sqrt(quietest) : differences;
}

}  // namespace dynoproof::score
