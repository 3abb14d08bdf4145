#include "thesis/tone.h"

#include <cmath>
#include <complex>
#include <numbers>

namespace dynoproof {

double AmplitudeAt(std::span<const double> values, double period_s, double f_Hz) {
  const auto n = static_cast<double>(values.size());
  std::complex<double> sum = 0.0;
  for (std::size_t i = 0; i < values.size(); ++i) {
    const double x = 2.0 * std::numbers::pi * static_cast<double>(i);
    sum += values[i] * (0.42 - 0.5 * std::cos(x / n) + 0.08 * std::cos(2.0 * x / n)) *
           std::polar(1.0, -x * f_Hz * period_s);
  }
  return 2.0 / (0.42 * n) * std::abs(sum);
}

Tone StrongestTone(std::span<const double> values, double period_s, double near_Hz, double half_Hz) {
  Tone best{near_Hz, 0.0};
  const auto search = [&](double centre, double half, double step) {
    for (double f = centre - half; f <= centre + half; f += step) {
      if (const double a = AmplitudeAt(values, period_s, f); a > best.amplitude) best = {f, a};
    }
  };
  search(near_Hz, half_Hz, 0.5);
  search(best.frequency_Hz, 0.6, 0.02);
  return best;
}

}  // namespace dynoproof
