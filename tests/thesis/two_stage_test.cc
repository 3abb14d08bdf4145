// Inertias and stiffnesses by resonances and zeros, then dampings by gains: (2.69) to (2.72) as a method of `identify`.
#include "thesis/two_stage.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

#include "identification/identify.h"
#include "tests/identification/response_misfits.h"

namespace dynoproof::identification {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::SizeIs;

using TwoStages = ResponseMisfits;

TEST_F(TwoStages, FindAStiffnessThenADampingAndTellWhatTheySaw) {
  AddTwoStage();
  Plan nominal = Of(kStiffness, 0.8);
  const double stiffness = nominal.root.FindPath(kStiffness)->number() / 0.8;
  *nominal.root.FindPath(kLoss) = Value(2.0 * kDamping);
  const Result<Identified> found =
      Identify(nominal, {Chirp()}, registry_, {{{kLoss, std::nullopt}, {kStiffness, std::nullopt}}, "two_stage"});
  ASSERT_TRUE(found.ok()) << found.failure().ToString();
  ASSERT_THAT(found->values, SizeIs(2));
  EXPECT_EQ(found->values[0].key, kStiffness);  // the first stage has it
  EXPECT_NEAR(found->values[0].value, stiffness,
              0.01 * stiffness);  // lines are half a hertz apart, at 391 Hz and above
  // A resonance loses a few percent of its height where four lines to either side are smoothed.
  EXPECT_NEAR(found->values[1].value, kDamping, 0.1 * kDamping);
  for (const IdentifiedValue& one : found->values) EXPECT_FALSE(one.interval.has_value()) << one.key;
  EXPECT_THAT(found->singular, SizeIs(2));
  ASSERT_TRUE(found->sighting.has_value());
  EXPECT_EQ(found->sighting->name, "landmarks");
  EXPECT_GE(found->sighting->numbers.at("resonances_hz").size(), 2U);
  EXPECT_EQ(found->sighting->numbers.at("gains").size(), found->sighting->numbers.at("resonances_hz").size());
  EXPECT_THAT(found->sighting->numbers.at("zeros_hz"), ElementsAre());  // from one end of a chain to the other
  EXPECT_THAT(ToTable(*found), HasSubstr("Hz; no zeros\n"));
}

}  // namespace
}  // namespace dynoproof::identification
