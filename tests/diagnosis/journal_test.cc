#include "diagnosis/journal.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>
#include <nlohmann/json.hpp>

namespace dynoproof::diagnosis {
namespace {

using ::testing::HasSubstr;

const Journal kJournal = {
    {"selection", {"a@b", "nominal model"}, "gain above the least one", {{"chi2_gain", 41.5}}, "the best"},
    {"verdict", {"a@b"}, "one candidate", {{"alike", std::numeric_limits<double>::quiet_NaN()}}, "effect_found"}};

TEST(Journal, HoldsStageRuleNumbersAndOutcome) {
  const nlohmann::json json = ToJson(kJournal);
  ASSERT_EQ(json.size(), 2u);
  EXPECT_EQ(json[0]["stage"], "selection");
  EXPECT_EQ(json[0]["compared"][1], "nominal model");
  EXPECT_EQ(json[0]["rule"], "gain above the least one");
  EXPECT_EQ(json[0]["numbers"]["chi2_gain"], 41.5);
  EXPECT_EQ(json[0]["outcome"], "the best");
  EXPECT_TRUE(json[1]["numbers"]["alike"].is_null()) << "never a number that is none";
}

TEST(Journal, NamesTheFirstOfManyAndCountsTheRest) {
  const Journal many = {{"screening", std::vector<std::string>(20, "a@b"), "a rule", {}, "fitted"}};
  EXPECT_THAT(ToText(many), HasSubstr("a@b and 12 more\n"));
  EXPECT_EQ(ToJson(many)[0]["compared"].size(), 20u);
}

TEST(Journal, ReadsAsText) {
  const std::string text = ToText(kJournal);
  for (const char* said : {"selection: a@b, nominal model", "rule: one candidate", "chi2_gain 41.5", "-> effect_found"})
    EXPECT_THAT(text, HasSubstr(said));
}

}  // namespace
}  // namespace dynoproof::diagnosis
