// How many digits of a parameter are shown.
#include <gtest/gtest.h>

#include <limits>

#include "diagnosis/diagnose.h"

namespace dynoproof::diagnosis {
namespace {

TEST(FoundParameter, ShowsTwoDigitsOfWhatItsIntervalLeavesOpen) {
  const FoundParameter sharp{"c_f", "N m s/rad", 0.100159, 0.100141, 0.100177};
  EXPECT_EQ(sharp.Text(sharp.value), "0.100159");
  EXPECT_EQ(sharp.Text(sharp.lower), "0.100141");
  const FoundParameter rough{"T_c", "N m", 13.51234, 10.0, 17.0};
  EXPECT_EQ(rough.Text(rough.value), "13.51");
  const FoundParameter negative{"delta", "1", -0.25001234, -0.250014, -0.250011};
  EXPECT_EQ(negative.Text(negative.value), "-0.2500123");
}

TEST(FoundParameter, OfNoWidthOrAnEndlessOneShowsFour) {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  EXPECT_EQ((FoundParameter{"k", "1", 1.0 / 3.0, 1.0 / 3.0, 1.0 / 3.0}.Text(1.0 / 3.0)), "0.3333");
  EXPECT_EQ((FoundParameter{"k", "1", 1.0 / 3.0, 0.0, kInfinity}.Text(1.0 / 3.0)), "0.3333");
  EXPECT_EQ((FoundParameter{"k", "1", 0.0, 0.0, 0.0}.Text(0.0)), "0");
}

}  // namespace
}  // namespace dynoproof::diagnosis
