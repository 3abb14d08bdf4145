// Differences of predictions that go in small stairs, as where an inertia breaks loose at one substep or the next.
#include "identification/finite_difference.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

namespace dynoproof::identification {
namespace {

constexpr double kWithin = 1.0, kOnTheWhole = 5.0;  // slopes: on a stair, and of the stairs

class DifferenceIn : public testing::Test {
 protected:
  DifferenceIn() : noise_(1000) {
    std::mt19937_64 dice(1);
    std::normal_distribution<double> normal;
    for (double& value : noise_) value = normal(dice);
  }
  /// White noise of one in one channel.
  Whitener Noise() const { return Whitener({{0, "T", "N m", 1.0, 1e-4, 1.0, 0, noise_.size()}}, noise_, 0); }
  Eigen::VectorXd Here() const { return Eigen::VectorXd::Zero(noise_.size()); }
  /// Every row rises by the same; stairs of 1e-3.
  Result<Eigen::VectorXd> Stairs(double x) {
    ++runs_;
    const double stair = 1e-3 * std::floor(x / 1e-3 + 0.5);
    return Eigen::VectorXd(Eigen::VectorXd::Constant(noise_.size(), kOnTheWhole * stair + kWithin * (x - stair)));
  }
  std::optional<Difference> Of(bool wide, double step = 1e-5, double most = 1e5) {
    return DifferenceOf([this](double x) { return Stairs(x); }, Here(), Noise(), step, wide, most);
  }
  static double Slope(const Difference& difference) { return difference.change[0] / difference.step; }

  Eigen::VectorXd noise_;
  int runs_ = 0;
};

TEST_F(DifferenceIn, SmallStepsSeesTheStairItStandsOn) {
  const std::optional<Difference> small = Of(false);
  ASSERT_TRUE(small);
  EXPECT_NEAR(Slope(*small), kWithin, 1e-9);
  EXPECT_EQ(small->step, 1e-5);
  EXPECT_EQ(runs_, 1);
}

TEST_F(DifferenceIn, WideStepsSeesAllStairs) {
  for (const double sign : {1.0, -1.0}) {
    runs_ = 0;
    const std::optional<Difference> wide = Of(true, sign * 1e-5);
    ASSERT_TRUE(wide);
    // Two deviations of noise on 1000 rows are 0.063 of a row: 13 stairs, of which half a one may be missed.
    EXPECT_NEAR(Slope(*wide), kOnTheWhole, 0.05 * kOnTheWhole);
    EXPECT_EQ(wide->step > 0.0, sign > 0.0);
    const double size = Noise()(wide->change).norm();
    EXPECT_GT(size, 1.0);
    EXPECT_LT(size, 6.0);
    EXPECT_EQ(wide->simulations, runs_);
    EXPECT_LE(runs_, 6);
  }
}

TEST_F(DifferenceIn, WideStepsGoesNoFurtherThanAllowed) {
  const std::optional<Difference> wide = Of(true, 1e-5, 10.0);
  ASSERT_TRUE(wide);
  EXPECT_NEAR(wide->step, 1e-4, 1e-12);
}

TEST_F(DifferenceIn, WhatBreaksFurtherOutKeepsTheSmallStepAndWhatBreaksAtOnceHasNone) {
  const auto breaks_at = [this](double most) {
    return DifferenceOf(
        [this, most](double x) {
          Result<Eigen::VectorXd> there = Stairs(x);
          if (std::abs(x) > most) (*there)[0] = std::numeric_limits<double>::quiet_NaN();
          return there;
        },
        Here(), Noise(), 1e-5, true);
  };
  const std::optional<Difference> kept = breaks_at(1e-4);
  ASSERT_TRUE(kept);
  EXPECT_EQ(kept->step, 1e-5);
  EXPECT_TRUE(kept->change.allFinite());
  EXPECT_FALSE(breaks_at(1e-6));
}

}  // namespace
}  // namespace dynoproof::identification
