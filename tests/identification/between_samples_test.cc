// What inputs do between their samples is told by the outputs of their own record.
#include "identification/between_samples.h"

#include <gtest/gtest.h>

#include <string>

#include "tests/estimation/made_record.h"

namespace dynoproof::identification {
namespace {

// Its inputs hold up to 900 Hz: held for 0.4 ms, they leave the true model three times the noise.
TEST(BetweenSamples, OfAScenarioWithPlayAreChosenAsOfAnyOther) {
  const Plan plan = estimation::Scenario("scenarios/diagnose/backlash.toml", {"run.duration_s=0.8"});
  MappedRecord record =
      estimation::Slower(estimation::RecordOf(plan, 0.005, {"omega_1", "omega_2", "omega_3", "T_m1"}), 4);
  ChooseBetween(plan, testing::BuiltIns(), record);
  EXPECT_EQ(record.between.at("T_1"), "band_limited_held");
  EXPECT_EQ(record.between.at("T_2"), "band_limited_held");
  ASSERT_EQ(record.notes.size(), 1U);
  EXPECT_NE(record.notes[0].find("band_limited_held"), std::string::npos) << record.notes[0];
}

}  // namespace
}  // namespace dynoproof::identification
