#include "identification/noise_model.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <random>

#include "tests/identification/made_noise.h"

namespace dynoproof::identification {
namespace {

// What a sensor's white noise gives between 0.7 and 0.95 of the Nyquist frequency, whatever moves below.
TEST(HighFrequencyFloors, IsTheNoiseUnderMotionAtLowFrequencies) {
  std::mt19937 random(31);
  for (int k = 0; k < 10; ++k) {
    Eigen::VectorXd signal = 0.02 * White(random, 4000);
    for (Eigen::Index i = 0; i < signal.size(); ++i) {
      const auto t = static_cast<double>(i);
      signal[i] += 3.0 * std::sin(0.013 * t) + std::sin(0.4 * t) + 2e-3 * t;
    }
    // The median of 500 exponentially distributed bins scatters by 1/(ln 2 sqrt(500)) = 6.5 % in power, 3.2 % in size.
    EXPECT_NEAR(HighFrequencyFloor(signal), 0.02, 0.02 * 4.0 * 0.032);
  }
}

// Burg's method against the model that made the record; nothing divides by zero where there is nothing.
TEST(AutoRegression, ComesBack) {
  std::mt19937 random(32);
  const ArModel model = FitAr(Coloured(random, 20000, 0.7, 0.0), 3);
  ASSERT_EQ(model.a.size(), 3u);
  // Standard deviation of a coefficient: 1/sqrt(n) = 0.007; the bounds are four of them.
  EXPECT_NEAR(model.a[0], 0.7, 0.028);
  EXPECT_NEAR(model.a[1], 0.0, 0.028);
  EXPECT_NEAR(model.sigma, 1.0, 0.02);
  EXPECT_GT(FitAr(Eigen::VectorXd::Zero(100), 3).sigma, 0.0);
}

}  // namespace
}  // namespace dynoproof::identification
