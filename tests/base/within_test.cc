#include "base/within.h"

#include <gtest/gtest.h>

#include <limits>

namespace dynoproof {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN(), kInf = std::numeric_limits<double>::infinity();

TEST(Within, TheLimitItselfIsHeld) {
  EXPECT_TRUE(Within(1.0, 1.0));
  EXPECT_TRUE(Within(-2.0, 1.0));
  EXPECT_FALSE(Within(1.0 + 1e-15, 1.0));
  EXPECT_TRUE(Reaches(1.0, 1.0));
  EXPECT_FALSE(Reaches(1.0, 1.0 + 1e-15));
}

TEST(Within, WhatIsNoNumberHoldsNothing) {
  for (const double none : {kNan, kInf, -kInf}) {
    EXPECT_FALSE(Within(none, 1.0));
    EXPECT_FALSE(Within(1.0, none));
    EXPECT_FALSE(Reaches(none, 1.0));
    EXPECT_FALSE(Reaches(1.0, none));
  }
}

}  // namespace
}  // namespace dynoproof
