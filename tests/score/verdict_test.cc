// Verdicts: order, combination, and that nothing undecided passes.
#include "score/verdict.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <vector>

namespace dynoproof::score {
namespace {

Check Of(Verdict verdict) {
  Check check;
  check.verdict = verdict;
  return check;
}

TEST(Verdict, WorstWinsInTheOrderOfTheExitCodes) {
  const std::vector<Verdict> worst_first = {Verdict::kBroken, Verdict::kFail, Verdict::kInconclusive, Verdict::kPass};
  for (std::size_t i = 0; i < worst_first.size(); ++i) {
    for (std::size_t j = i; j < worst_first.size(); ++j) {
      EXPECT_EQ(Worse(worst_first[i], worst_first[j]), worst_first[i]);
      EXPECT_EQ(Worse(worst_first[j], worst_first[i]), worst_first[i]);
      EXPECT_EQ(Combine(std::vector<Check>{Of(worst_first[j]), Of(worst_first[i]), Of(worst_first[j])}),
                worst_first[i]);
    }
  }
}

TEST(Verdict, NothingComparedFails) { EXPECT_EQ(Combine({}), Verdict::kFail); }

TEST(Verdict, ExitCodesAndNamesAreThoseOfTheContract) {
  EXPECT_EQ(ExitCode(Verdict::kPass), 0);
  EXPECT_EQ(ExitCode(Verdict::kFail), 1);
  EXPECT_EQ(ExitCode(Verdict::kBroken), 3);
  EXPECT_EQ(ExitCode(Verdict::kInconclusive), 4);
  EXPECT_EQ(ToString(Verdict::kPass), "pass");
  EXPECT_EQ(ToString(Verdict::kFail), "fail");
  EXPECT_EQ(ToString(Verdict::kBroken), "broken");
  EXPECT_EQ(ToString(Verdict::kInconclusive), "inconclusive");
}

TEST(Verdict, FreshOutcomeAndCheckFail) {
  EXPECT_FALSE(Outcome{}.ok());
  EXPECT_EQ(Check{}.verdict, Verdict::kFail);
}

TEST(Verdict, LimitHoldsOnItsEdgeOnly) {
  EXPECT_EQ(AtMost("a", "claim", 1.0, 1.0, "Hz", "printed").verdict, Verdict::kPass);
  const Check above = AtMost("a", "claim", std::nextafter(1.0, 2.0), 1.0, "Hz", "printed");
  EXPECT_EQ(above.verdict, Verdict::kFail);
  EXPECT_FALSE(above.explanation.empty());
  EXPECT_EQ(above.origin, "printed");
}

TEST(Verdict, NumbersThatAreNoneFail) {
  const double nan = std::numeric_limits<double>::quiet_NaN(), inf = std::numeric_limits<double>::infinity();
  for (const auto& [value, limit] :
       {std::pair{nan, 1.0}, {0.0, nan}, {nan, nan}, {inf, inf}, {0.0, inf}, {-inf, 1.0}}) {
    const Check check = AtMost("a", "claim", value, limit, "", "");
    EXPECT_EQ(check.verdict, Verdict::kFail) << value << " " << limit;
    EXPECT_FALSE(check.explanation.empty());
  }
}

TEST(Verdict, OutcomeThatFailedStaysFailedWhateverItsNumber) {
  const Check check = ToCheck({Verdict::kInconclusive, "why"}, "a", "tube", 0.0, 1.0, "", "");
  EXPECT_EQ(check.verdict, Verdict::kInconclusive);
  EXPECT_EQ(check.explanation, "why");
}

TEST(Verdict, ALowerBoundHoldsFromItsLimitOn) {
  EXPECT_EQ(AtLeast("", "", 0.484, 0.1, "1", "").verdict, Verdict::kPass);
  EXPECT_EQ(AtLeast("", "", 0.1, 0.1, "1", "").verdict, Verdict::kPass);
  const Check fallen = AtLeast("", "", 0.05, 0.1, "1", "");
  EXPECT_EQ(fallen.verdict, Verdict::kFail);
  EXPECT_NE(fallen.explanation, "");
  for (const Check& check : {AtLeast("", "", std::nan(""), 0.1, "1", ""), AtLeast("", "", INFINITY, 0.1, "1", ""),
                             AtLeast("", "", 1.0, -INFINITY, "1", "")})
    EXPECT_EQ(check.verdict, Verdict::kFail);
  EXPECT_TRUE(fallen.at_least);
  EXPECT_FALSE(AtMost("", "", 0.05, 0.1, "1", "").at_least);
}

}  // namespace
}  // namespace dynoproof::score
