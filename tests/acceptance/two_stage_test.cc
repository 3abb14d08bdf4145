// `dynoproof identify --method two_stage`, which the thesis brings along, from outside.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/acceptance/identify_line.h"

namespace dynoproof::test {
namespace {

using ::testing::HasSubstr;
using ::testing::SizeIs;

using TwoStage = IdentifyLine;

// Three masses have two resonances; from the torque on the first one to that in the last shaft there is no zero.
TEST_F(TwoStage, FindsWhatIsFarOffAndTellsWhatItSaw) {
  Record({}, 10.0);
  const nlohmann::json result = Json(FarOff({"--method", "two_stage"}));
  ExpectFound(result, 0.02);
  EXPECT_THAT(result["landmarks"]["resonances_hz"], SizeIs(2)) << result.dump(1);
  EXPECT_THAT(result["landmarks"]["gains"], SizeIs(2));
  EXPECT_THAT(result["landmarks"]["zeros_hz"], SizeIs(0));
}

TEST_F(TwoStage, FindsADampingByTheHeightOfAResonance) {
  Record({}, 10.0);
  const std::string damping = "plant.shaft.k2.damping_Nms_per_rad";
  const nlohmann::json result =
      Json({"--method", "two_stage", "--free", damping, "--bound", damping + "=0:100", "--set", damping + "=0"});
  // What is smoothed over half a hertz loses a few percent of a resonance's height.
  EXPECT_NEAR(result["parameters"][damping]["value"].get<double>(), 6.0, 0.3) << result.dump(1);
  EXPECT_TRUE(result["parameters"][damping]["ci95"].is_null());
}

TEST_F(TwoStage, TakesNoStagesAndNeedsAFrequencyResponse) {
  Record();
  const Outcome staged = Call({"--set", R"(output.T_shaft.sensor=[{type="first_order_lag",tau_s=0.0005}])", "--free",
                               kInertia, "--method", "two_stage"});
  EXPECT_EQ(staged.exit, 2);
  EXPECT_THAT(staged.err, HasSubstr("output.T_shaft.sensor is no part"));
  ExpectToNeedAnalysis("two_stage");
}

}  // namespace
}  // namespace dynoproof::test
