// A sensor at the end of its range is told from a signal that comes to rest.
#include "diagnosis/value_check.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>

namespace dynoproof::diagnosis {
namespace {

std::size_t Clipped(const std::function<double(double)>& of) {
  trace::Column column{.name = "x"};
  for (int i = 0; i < 1000; ++i) column.values.push_back(of(i / 1000.0));
  std::vector<Finding> findings;
  CheckValues(column, nullptr, findings);
  std::size_t count = 0;
  for (const Finding& one : findings) count += one.kind == "clipping" ? one.count : 0;
  return count;
}

TEST(ValueCheck, ASensorEndsWhereMotionStopsAtOnce) {
  const auto pulse = [](double t) { return std::exp(-std::pow((t - 0.4) / 0.1, 2)) + 0.1 * std::sin(7.0 * t); };
  EXPECT_EQ(Clipped(pulse), 0u);
  EXPECT_NEAR(static_cast<double>(Clipped([&](double t) { return std::min(pulse(t), 0.8); })), 120.0, 20.0);
  const auto swing = [](double t) { return std::sin(40.0 * t); };
  EXPECT_GT(Clipped([&](double t) { return std::clamp(swing(t), -0.9, 0.9); }), 200u) << "at both ends";
}

TEST(ValueCheck, WhatComesToRestByItselfIsNotClipped) {
  // A ramp that ends smoothly in a rest at its largest value and goes back; one that rests before it starts; one that stays where it stops.
  const auto ease = [](double s) { return s <= 0.0 ? 0.0 : s >= 1.0 ? 1.0 : s * s * (3.0 - 2.0 * s); };
  EXPECT_EQ(Clipped([&](double t) { return ease(3.0 * t) - 0.5 * ease(3.0 * (t - 0.6)); }), 0u);
  EXPECT_EQ(Clipped([](double t) { return std::max(t, 0.3); }), 0u);
  EXPECT_EQ(Clipped([](double t) { return std::min(t, 0.7); }), 0u);
}

}  // namespace
}  // namespace dynoproof::diagnosis
