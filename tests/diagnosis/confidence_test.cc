#include "diagnosis/confidence.h"

#include <gtest/gtest.h>

#include "diagnosis/confidence_cases.h"

namespace dynoproof::diagnosis {
namespace {

TEST(Confidence, IsTheShareOfMadeCasesThatWereRight) {
  for (const MadeCases& one : kMadeCases) {
    const std::optional<double> told = ConfidenceOf(one.verdict, one.several ? 2 : 1);
    ASSERT_EQ(told.has_value(), one.count >= 20) << ToString(one.verdict);
    if (!told) continue;
    EXPECT_GT(*told, 0.0);
    EXPECT_LT(*told, 1.0) << "nothing is certain";
    EXPECT_NEAR(*told, static_cast<double>(one.right) / one.count, 0.5 / one.count);
  }
}

TEST(Confidence, OfAVerdictThatShowsNoEffectIsNone) { EXPECT_FALSE(ConfidenceOf(Conclusion::kNoEffect, 0)); }

TEST(Confidence, OfACauseThatStandsAloneIsHigherThanOfOneThatExplainsNotAll) {
  const auto found = ConfidenceOf(Conclusion::kEffectFound, 1), part = ConfidenceOf(Conclusion::kUnexplained, 1);
  ASSERT_TRUE(found);
  EXPECT_GT(*found, part.value_or(0.5));
}

}  // namespace
}  // namespace dynoproof::diagnosis
