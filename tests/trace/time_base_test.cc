// Stamps as instants: what is a grid within its digits is that, all else keeps its own instants.
#include "trace/time_base.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <vector>

#include "base/random.h"

namespace dynoproof::trace {
namespace {

std::vector<double> Grid(double step, int count, double start = 0.0) {
  std::vector<double> stamps;
  for (int i = 0; i < count; ++i) stamps.push_back(start + i * step);
  return stamps;
}

/// As a file with so many decimals gives them back.
std::vector<double> Printed(std::vector<double> stamps, double digit) {
  for (double& t : stamps) t = std::round(t / digit) * digit;
  return stamps;
}

TEST(TimeBase, AGridIsOneWithinTheDigitsOfItsStamps) {
  for (const double start : {0.0, 12.3456, 1687168800.0}) {
    for (const double step : {1e-3, 1.6384e-3, 1.0 / 1024.0, 1.0 / 3000.0}) {
      const TimeBase base = TimeBaseOf(Printed(Grid(step, 2000, start), 1e-6));
      ASSERT_TRUE(base.uniform()) << start << " " << step;
      // Two thousand stamps of half a digit tell the step to a digit over their span.
      EXPECT_NEAR(base.step_s, step, 1e-6 / 2000.0) << start;
      EXPECT_EQ(base.dropped, 0U);
      EXPECT_EQ(base.time_s.size(), 2000U);
    }
  }
}

TEST(TimeBase, WhatDigitsLeaveOfAStepIsSaid) {
  // 610.35 Hz in tenths of a millisecond: 1.6384 ms goes through the stamps as well, and has as many digits.
  const TimeBase odd = TimeBaseOf(Printed(Grid(1.0 / 610.35, 400), 1e-4));
  ASSERT_TRUE(odd.uniform());
  EXPECT_FALSE(odd.plain);
  EXPECT_LT(std::abs(odd.step_s * 610.35 - 1.0), odd.step_range);
  EXPECT_LT(odd.step_range, 1e-4 / 0.6);  // a digit over the span
  const TimeBase usual = TimeBaseOf(Printed(Grid(1e-3, 400, 0.0004), 1e-4));
  EXPECT_TRUE(usual.plain && usual.exact);
  EXPECT_DOUBLE_EQ(usual.step_s, 1e-3);
  EXPECT_FALSE(odd.exact);
}

TEST(TimeBase, ManyStampsThatAreKnownToRoundOffAreAGrid) {
  // 12 kHz in microseconds, from 12.3456 s on: sums over the stamps lose more than an ulp of them.
  const TimeBase base = TimeBaseOf(Grid(1e6 / 12e3, 7200, 12345600.0), 1e-6);
  ASSERT_TRUE(base.uniform());
  EXPECT_NEAR(base.step_s * 12e3, 1.0, 1e-14);
}

TEST(TimeBase, NanosecondsAndSinglePrecisionAreDigitsToo) {
  EXPECT_DOUBLE_EQ(TimeBaseOf(Grid(1e6, 500, 1687168800e9), 1e-9).step_s, 1e-3);
  std::vector<double> single = Grid(1e-3, 500, 1000.0);
  for (double& t : single) t = static_cast<double>(static_cast<float>(t));
  EXPECT_DOUBLE_EQ(TimeBaseOf(single).step_s, 1e-3);
}

TEST(TimeBase, RowsThatAreMissingAreCounted) {
  for (const double share : {0.1, 0.5, 0.7}) {
    std::vector<double> kept;
    std::size_t dropped = 0;
    for (int i = 0; i < 1000; ++i) {
      if (i > 0 && i < 999 && RandomUniform(1, 2, static_cast<std::uint64_t>(i)) < share)
        ++dropped;
      else
        kept.push_back(5.0 + 1e-3 * i);
    }
    const TimeBase base = TimeBaseOf(kept);
    ASSERT_TRUE(base.uniform()) << share;
    EXPECT_DOUBLE_EQ(base.step_s, 1e-3);
    EXPECT_EQ(base.dropped, dropped);
    EXPECT_DOUBLE_EQ(base.time_s.back(), 0.999);
  }
}

TEST(TimeBase, OneRowThatIsMissingUnderStampsOfFewDigits) {
  for (const int missing : {1, 100, 500, 799, 1000, 1500, 1998}) {
    std::vector<double> kept;
    for (int i = 0; i < 2000; ++i) {
      if (i != missing) kept.push_back(i / 1000.0);
    }
    const TimeBase base = TimeBaseOf(kept);
    ASSERT_TRUE(base.uniform()) << missing;
    EXPECT_DOUBLE_EQ(base.step_s, 1e-3);
    EXPECT_EQ(base.dropped, 1U) << missing;
    EXPECT_EQ(base.longest_gap_row, static_cast<std::size_t>(missing));
    EXPECT_DOUBLE_EQ(base.time_s.back(), 1.999) << missing;
  }
  for (const double rate_hz : {960.0, 990.0, 1024.0}) {  // its rounding leaves steps of two digits, too
    std::vector<double> stamps;
    for (int i = 0; i < 2000; ++i) stamps.push_back(std::round(i * 1000.0 / rate_hz) / 1000.0);
    const TimeBase base = TimeBaseOf(stamps);
    ASSERT_TRUE(base.uniform()) << rate_hz;
    EXPECT_NEAR(base.step_s, 1.0 / rate_hz, 1e-7);  // 2 s of three digits tell it to 2.5e-7
    EXPECT_EQ(base.dropped, 0U) << rate_hz;
  }
}

TEST(TimeBase, JitterIsNoGrid) {
  std::vector<double> stamps = Grid(1e-3, 500);
  for (std::size_t i = 1; i < stamps.size(); ++i) stamps[i] += 1e-4 * (RandomUniform(3, 4, i) - 0.5);
  const TimeBase base = TimeBaseOf(stamps);
  EXPECT_FALSE(base.uniform());
  EXPECT_NEAR(base.usual_step_s, 1e-3, 1e-5);
  EXPECT_GT(base.jitter_s, 5e-5);
  EXPECT_LT(base.jitter_s, 1.1e-4);
  EXPECT_EQ(base.time_s[7], stamps[7]);
  EXPECT_THAT(base.Notes("t"), ::testing::Contains(::testing::HasSubstr("not equal")));
}

TEST(TimeBase, RowsAtOneInstantAreAnEvent) {
  const std::vector<double> stamps = {0.0, 1e-3, 1e-3, 1e-3, 2e-3, 3e-3, 3e-3, 4e-3};
  const TimeBase base = TimeBaseOf(stamps);
  EXPECT_EQ(base.events, 2U);
  EXPECT_EQ(base.time_s.size(), 5U);
  EXPECT_EQ(base.first_row[1], 1U);
  EXPECT_EQ(base.last_row[1], 3U);
  EXPECT_EQ(FirstFaultOf(stamps), stamps.size());
  EXPECT_EQ(FirstFaultOf(std::vector<double>{0.0, 2.0, 1.0}), 2U);
  EXPECT_EQ(FirstFaultOf(std::vector<double>{0.0, std::nan(""), 1.0}), 1U);
}

TEST(TimeBase, FastRowsUnderCoarseStampsAreNoEvents) {
  const TimeBase base = TimeBaseOf(Printed(Grid(0.25e-3, 400), 1e-3));
  EXPECT_EQ(base.events, 0U);
  EXPECT_NEAR(base.step_s, 0.25e-3, 1e-3 / 400.0);
  EXPECT_EQ(base.time_s.size(), 400U);
}

}  // namespace
}  // namespace dynoproof::trace
