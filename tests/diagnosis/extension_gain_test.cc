// Which gains speak for an extension.

#include "diagnosis/extension_gain.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>

namespace dynoproof::diagnosis {
namespace {

using ::testing::HasSubstr;
using ::testing::IsEmpty;

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
const SignalGain kGained{0.5, 0.1, 0.3, 0.5}, kLost{0.1, 0.5, -0.5, -0.3}, kAlike{0.1, 0.1, -0.01, 0.01};

TEST(ExtensionGain, IsAGainOnTheHoldoutAndNoLossAnywhere) {
  EXPECT_THAT(Lacking({{"h", true, {{"T", kGained}, {"w", kAlike}}}}), IsEmpty());
  EXPECT_THAT(Lacking({{"h", true, {{"T", kGained}}}, {"r", false, {{"T", kAlike}}}}), IsEmpty());
  EXPECT_THAT(Lacking({{"h", true, {{"T", kAlike}}}, {"r", false, {{"T", kGained}}}}), HasSubstr("includes zero"));
  EXPECT_THAT(Lacking({{"h", true, {{"T", kGained}, {"w", kLost}}}}), HasSubstr("h: w is foretold worse"));
  EXPECT_THAT(Lacking({{"h", true, {{"T", kGained}}}, {"r", false, {{"w", kLost}}}}), HasSubstr("r: w is foretold"));
}

TEST(ExtensionGain, IsNoDifferenceOfRoundOff) {
  EXPECT_THAT(Lacking({{"h", true, {{"T", {0.5, 0.5, 1e-13, 2e-13}}}}}), HasSubstr("includes zero"));
  EXPECT_THAT(Lacking({{"h", true, {{"T", kGained}, {"w", {0.5, 0.5, -2e-13, -1e-13}}}}}), IsEmpty());
}

TEST(ExtensionGain, IsNothingThatIsNoNumberOrNotCompared) {
  for (const SignalGain& gain : {SignalGain{0.5, kNan, 0.3, 0.5}, SignalGain{0.5, 0.1, kNan, 0.5},
                                 SignalGain{0.5, 0.1, 0.3, kNan}, SignalGain{kNan, 0.1, 0.3, 0.5}}) {
    EXPECT_THAT(Lacking({{"h", true, {{"T", gain}, {"w", kGained}}}}), HasSubstr("no number"));
    EXPECT_THAT(Lacking({{"h", true, {{"T", kGained}}}, {"r", false, {{"T", gain}}}}), HasSubstr("no number"));
  }
  EXPECT_THAT(Lacking({{"h", true, {}}}), HasSubstr("nothing compared"));
  EXPECT_THAT(Lacking({{"h", true, {{"T", kGained}}}, {"r", false, {}}}), HasSubstr("r: nothing compared"));
  EXPECT_FALSE(Lacking({}).empty());
}

}  // namespace
}  // namespace dynoproof::diagnosis
