// What a Jacobian tells of each number, and of which it tells a combination alone.
#include "identification/told_apart.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

namespace dynoproof::identification {
namespace {

using ::testing::ElementsAre;
using ::testing::UnorderedElementsAre;

TEST(ToldApart, NumbersThatAreSeenHaveNoSet) {
  Eigen::MatrixXd jacobian(3, 2);
  jacobian << 3.0, 0.0, 0.0, 2.0, 0.0, 0.0;
  const ToldApart told = TellApart(jacobian, 1.0, {"a", "b"});
  EXPECT_TRUE(told.alike.empty());
  EXPECT_THAT(told.singular, ElementsAre(::testing::DoubleNear(3.0, 1e-12), ::testing::DoubleNear(2.0, 1e-12)));
  EXPECT_NEAR(told.inverse(0, 0), 1.0 / 9.0, 1e-12);
  EXPECT_TRUE(told.Tells("a"));
}

TEST(ToldApart, TwoThatActAlikeAreOneSet) {
  Eigen::MatrixXd jacobian(4, 3);
  for (int i = 0; i < 4; ++i) jacobian.row(i) << std::cos(i), 2.0 * std::cos(i), std::sin(2.0 * i);
  const ToldApart told = TellApart(jacobian, 1e-6, {"a", "b", "c"});
  ASSERT_EQ(told.alike.size(), 1u);
  EXPECT_THAT(told.alike[0], UnorderedElementsAre("a", "b"));
  EXPECT_FALSE(told.Tells("a"));
  EXPECT_TRUE(told.Tells("c"));
}

TEST(ToldApart, WhatTheNoiseCoversIsNotSeen) {
  Eigen::MatrixXd jacobian(2, 2);
  jacobian << 1.0, 0.0, 0.0, 0.05;
  EXPECT_TRUE(TellApart(jacobian, 1e-4, {"a", "b"}).alike.empty());
  EXPECT_THAT(TellApart(jacobian, 1.0, {"a", "b"}).alike, ElementsAre(ElementsAre("b")));
}

}  // namespace
}  // namespace dynoproof::identification
