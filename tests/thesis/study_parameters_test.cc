#include "thesis/study_parameters.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace dynoproof {
namespace {

using ::testing::HasSubstr;

TEST(StudyParameters, NumbersAndSwitches) {
  const Value claim{{"factor", 1.5}, {"as_printed", true}, {"below", "all"}};
  const Result<double> factor = Number(claim, "factor");
  ASSERT_TRUE(factor.ok());
  EXPECT_EQ(*factor, 1.5);
  EXPECT_TRUE(Flag(claim, "as_printed"));
  EXPECT_FALSE(Flag(claim, "reversed"));
  EXPECT_FALSE(Flag(claim, "factor"));
}

TEST(StudyParameters, WhatIsMissingOrNoNumberIsBadInput) {
  const Value claim{{"below", "all"}};
  for (const char* key : {"below", "factor"}) {
    const Result<double> number = Number(claim, key);
    ASSERT_FALSE(number.ok()) << key;
    EXPECT_EQ(number.failure().exit_code, 2);
    EXPECT_EQ(number.failure().signal, "study");
    EXPECT_THAT(number.failure().message, HasSubstr(key));
  }
}

}  // namespace
}  // namespace dynoproof
