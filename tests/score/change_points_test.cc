#include "score/change_points.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <random>

namespace dynoproof::score {
namespace {

using ::testing::IsEmpty;
using ::testing::SizeIs;

/// Times of a benchmark: 2 % scatter, and now and then a burst of another tenant.
std::vector<double> Nights(std::size_t count, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> uniform;
  std::vector<double> values;
  for (std::size_t i = 0; i < count; ++i) {
    values.push_back(100.0 * (1.0 + 0.02 * normal(random)) * (uniform(random) < 0.1 ? 1.5 : 1.0));
  }
  return values;
}

TEST(ChangePoints, AStepIsFoundWhereItIsInSpiteOfOutliers) {
  int found = 0;
  constexpr int kSeries = 100;
  for (int seed = 0; seed < kSeries; ++seed) {
    std::vector<double> values = Nights(40, seed);
    for (std::size_t i = 25; i < values.size(); ++i) values[i] *= 1.06;
    for (const LevelChange& change : NoisyChanges(values, {})) {
      const bool here = change.at >= 23 && change.at <= 27 && std::abs(change.after / change.before - 1.06) < 0.03;
      found += here && change.p < 0.01 ? 1 : 0;
    }
  }
  RecordProperty("found", found);
  EXPECT_GE(found, 75);  // some series have so many bursts that nobody could tell
}

TEST(ChangePoints, TwoStepsAreTwo) {
  std::vector<double> values = Nights(60, 4);
  for (std::size_t i = 20; i < 40; ++i) values[i] *= 1.2;
  const std::vector<LevelChange> changes = NoisyChanges(values, {});
  ASSERT_THAT(changes, SizeIs(2));
  EXPECT_GT(changes[0].after, changes[0].before);
  EXPECT_LT(changes[1].after, changes[1].before);
}

TEST(ChangePoints, FalseAlarmsAreAsRareAsStated) {
  int alarms = 0;
  constexpr int kSeries = 400;
  NoiseOptions options;
  options.alpha = 0.05;
  options.relevant = 0.0;
  for (int i = 0; i < kSeries; ++i) alarms += NoisyChanges(Nights(30, 100 + i), options).empty() ? 0 : 1;
  // 20 are expected at 5 %; binomial: more than 33 of 400 come once in a thousand.
  EXPECT_LE(alarms, 33);
  EXPECT_GE(alarms, 6) << "a test that never finds anything is none";
}

TEST(ChangePoints, WhatIsTooSmallToMatterIsLeftAlone) {
  std::vector<double> values;
  for (int i = 0; i < 40; ++i) values.push_back(i < 20 ? 100.0 : 101.0);
  EXPECT_THAT(NoisyChanges(values, {}), IsEmpty());
}

TEST(ChangePoints, ShortSeriesCannotDecide) {
  NoiseOptions options;
  EXPECT_FALSE(CanDecide(9, options));
  EXPECT_TRUE(CanDecide(12, options));
  options.alpha = 1e-4;
  EXPECT_FALSE(CanDecide(12, options));
  EXPECT_TRUE(CanDecide(22, options));
}

TEST(ChangePoints, ExactValuesChangeAtOnceAndCreepIsFound) {
  const std::vector<double> step = {338.9, 338.9, 345.0, 345.0};
  ASSERT_THAT(ExactChanges(step, 3.4), SizeIs(1));
  EXPECT_EQ(ExactChanges(step, 3.4)[0].at, 2u);
  const std::vector<double> creep = {100.0, 100.4, 100.8, 101.2, 101.6};
  ASSERT_THAT(ExactChanges(creep, 1.0), SizeIs(1));
  EXPECT_EQ(ExactChanges(creep, 1.0)[0].at, 3u);
  EXPECT_THAT(ExactChanges(std::vector<double>{5.0}, 0.0), IsEmpty());
}

}  // namespace
}  // namespace dynoproof::score
