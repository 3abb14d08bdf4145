#include "estimation/data_set.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/estimation/four_masses.h"
#include "tests/estimation/made_record.h"

namespace dynoproof::estimation {
namespace {

TEST(DataSet, HoldsChannelBehindChannelWithItsNoise) {
  const Plan plan = FourMasses(0.5);
  const MappedRecord record = RecordOf(plan, 0.01, {"T_shaft", "omega_1"});
  const DataSet data({record, record}, plan);
  ASSERT_EQ(data.channels().size(), 4u);
  Eigen::Index next = 0;
  for (const Channel& channel : data.channels()) {
    EXPECT_EQ(channel.begin, next);
    next += channel.count;
    const std::vector<double>& values = *record.outputs.at(channel.name).values;
    ASSERT_EQ(channel.count, std::ssize(values));
    EXPECT_EQ(data.measured()[channel.begin + 7], values[7]);
    EXPECT_EQ(data.time_s()[static_cast<std::size_t>(channel.begin) + 7], record.outputs.at(channel.name).time->at(7));
    // White noise of a hundredth of the spread, told to 5 % by 5000 samples; differences hold some of the torque's fast modes.
    EXPECT_NEAR(channel.white / (0.01 * channel.spread), 1.0, channel.name == "omega_1" ? 0.05 : 0.2) << channel.name;
    EXPECT_EQ(channel.noise, channel.white);
  }
  EXPECT_EQ(next, data.measured().size());
  EXPECT_EQ(data.channels()[0].record, 0u);
  EXPECT_EQ(data.channels()[3].record, 1u);
  EXPECT_EQ(data.channels()[0].unit, "N m");
}

TEST(DataSet, WithoutNoiseCountsAsMeasuredToATenThousandthOfTheSpread) {
  const Plan plan = FourMasses(0.3);
  const DataSet data({RecordOf(plan, 0.0, {"omega_4"})}, plan);
  const Channel& channel = data.channels().front();
  EXPECT_EQ(channel.noise, std::max(channel.white, 1e-4 * channel.spread));
}

/// A signal that stands still has no spread: squares over its noise are numbers all the same.
TEST(DataSet, WhatStandsStillCountsAsMeasuredToABillionthOfItsSize) {
  const Plan plan = FourMasses(0.3);
  MappedRecord record = RecordOf(plan, 0.0, {"omega_4"});
  Series& still = record.outputs.at("omega_4");
  still.values = std::make_shared<const std::vector<double>>(still.values->size(), 3.0);
  const double size = plan.root.NumberOr("output.omega_4.nominal", 0.0);
  ASSERT_GT(size, 0.0);
  const DataSet data({record}, plan);
  EXPECT_EQ(data.channels().front().noise, 1e-9 * size);
  EXPECT_EQ(data.channels().front().OfSpread(size), 0.0);
}

TEST(DataSet, TakesAStretchAndNoMoreRowsThanIsAsked) {
  const Plan plan = FourMasses(0.5);
  const MappedRecord record = RecordOf(plan, 0.01, {"T_shaft", "omega_1"});
  const DataSet data({record}, plan, {.from_s = 0.1, .most_s = 0.4, .most_rows = 1000});
  EXPECT_NEAR(data.records().front().end_s, 0.4, 1e-12);
  EXPECT_NEAR(data.records().front().outputs.at("omega_1").time->back(), 0.4, 1e-9) << "all rows up to there correct";
  EXPECT_NEAR(data.records().front().outputs.at("omega_1").time->front(), 0.0, 1e-12);
  for (const Channel& channel : data.channels()) {
    EXPECT_EQ(channel.count, 751) << "every fourth of 3001 rows: of every third there are 1001";
    EXPECT_NEAR(data.time_s()[static_cast<std::size_t>(channel.begin)], 0.1, 1e-9);
    EXPECT_NEAR(data.time_s()[static_cast<std::size_t>(channel.begin) + 1], 0.1004, 1e-9);
  }
}

TEST(BlocksOf, CoverEachRowOnceAndNoOtherRecord) {
  const Plan plan = FourMasses(0.3);
  const MappedRecord record = RecordOf(plan, 0.01, {"T_shaft", "omega_1"});
  const DataSet data({record, record}, plan);
  const std::vector<Block> blocks = BlocksOf(data);
  ASSERT_EQ(blocks.size(), 80u);
  std::vector<int> seen(static_cast<std::size_t>(data.measured().size()), 0);
  for (std::size_t b = 0; b < blocks.size(); ++b) {
    for (const Block::Rows& rows : blocks[b].rows) {
      EXPECT_EQ(data.channels()[rows.channel].record, b / 40);
      for (Eigen::Index i = rows.begin; i < rows.begin + rows.count; ++i) ++seen[static_cast<std::size_t>(i)];
    }
  }
  EXPECT_THAT(seen, ::testing::Each(1));
}

}  // namespace
}  // namespace dynoproof::estimation
