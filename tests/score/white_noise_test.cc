#include "score/white_noise.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "base/random.h"
#include "score/series.h"

namespace dynoproof::score {
namespace {

/// Sines over all frequencies up to `share` of the sampling rate.
std::vector<double> Moving(std::size_t count, double share) {
  std::vector<double> values(count);
  for (int line = 1; line <= 40; ++line) {
    const double omega = 2.0 * std::numbers::pi * share * line / 40.0;
    for (std::size_t i = 0; i < count; ++i) values[i] += std::sin(omega * static_cast<double>(i) + 0.7 * line * line);
  }
  return values;
}

std::vector<double> Noise(std::size_t count, double sigma, std::uint64_t seed) {
  std::vector<double> values(count);
  for (std::size_t i = 0; i < count; ++i) values[i] = sigma * RandomNormal(seed, 0, i);
  return values;
}

std::vector<double> Sum(std::vector<double> a, const std::vector<double>& b) {
  for (std::size_t i = 0; i < a.size(); ++i) a[i] += b[i];
  return a;
}

TEST(WhiteNoise, IsFoundUnderSlowMotion) {
  EXPECT_NEAR(WhiteNoise(Sum(Moving(4000, 0.05), Noise(4000, 0.01, 1))), 0.01, 5e-4);
  EXPECT_NEAR(WhiteNoise(Sum(Moving(300, 0.05), Noise(300, 0.01, 2))), 0.01, 2e-3);
}

TEST(WhiteNoise, OfNoiseAloneNoEighthOfTheFrequenciesHasLessThanHalf) {
  for (std::uint64_t seed = 0; seed < 200; ++seed) EXPECT_NEAR(WhiteNoise(Noise(2000, 1.0, seed)), 1.0, 0.2) << seed;
}

/// Sixth differences of such motion are no smaller than the signal itself.
TEST(WhiteNoise, FastMotionIsNone) {
  const std::vector<double> fast = Moving(4000, 0.4);
  EXPECT_LT(WhiteNoise(fast), 1e-6 * StandardDeviation(fast));
  EXPECT_NEAR(WhiteNoise(Sum(fast, Noise(4000, 0.01, 3))), 0.01, 1e-3);
}

TEST(WhiteNoise, ImpactsAreNone) {
  std::vector<double> values = Sum(Moving(4000, 0.05), Noise(4000, 0.01, 4));
  for (std::size_t i = 500; i < values.size(); i += 700) values[i] += 20.0;
  EXPECT_NEAR(WhiteNoise(values), 0.01, 1e-3);
}

TEST(WhiteNoise, OfFewSamplesNothingIsKnown) {
  EXPECT_EQ(WhiteNoise({1.0, 2.0, 1.0, 2.0, 1.0, 2.0}), 0.0);
  EXPECT_EQ(WhiteNoise(std::vector<double>(1000, 3.0)), 0.0);
}

}  // namespace
}  // namespace dynoproof::score
