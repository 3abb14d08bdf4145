// The clock of the benchmarks: a figure that two ways agree on, or none.
#include "bench/clock.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace dynoproof {
namespace {

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

TEST(Clock, IsToldWhereTwoChainsAgree) {
  EXPECT_EQ(AgreedGHz(3.1, 3.0), 3.1) << "what disturbs only slows, so the faster chain is nearer";
  EXPECT_EQ(AgreedGHz(3.0, 3.1), 3.1);
}

TEST(Clock, IsNoFigureRatherThanAFalseOne) {
  EXPECT_TRUE(std::isnan(AgreedGHz(23.9, 3.1))) << "constants added while registers are renamed";
  EXPECT_TRUE(std::isnan(AgreedGHz(3.1, 1.0))) << "multiplications that take other than three cycles";
  EXPECT_TRUE(std::isnan(AgreedGHz(kNone, 3.1)));
  EXPECT_TRUE(std::isnan(AgreedGHz(3.1, kNone)));
  EXPECT_TRUE(std::isnan(AgreedGHz(0.0, 0.0)));
}

}  // namespace
}  // namespace dynoproof
