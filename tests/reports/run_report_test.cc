// The Markdown of a run: worst first, and below 1 MiB whatever the run.
#include "reports/run_report.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

namespace dynoproof::reports {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

constexpr std::size_t kMebibyte = 1U << 20;

ScenarioResult Result(const std::string& id, score::Verdict verdict, int checks, const std::string& explanation) {
  ScenarioResult result;
  result.id = id;
  result.verdict = verdict;
  for (int i = 0; i < checks; ++i) {
    score::Check& check = result.checks.emplace_back();
    check.name = fmt::format("check {}", i);
    check.verdict = verdict;
    check.explanation = explanation;
    check.origin = "made up";
  }
  return result;
}

TEST(Cards, OneForAllSignalsThatOneComparisonFindsOff) {
  ScenarioResult result = Result("s", score::Verdict::kFail, 3, "");
  const char* const names[] = {"golden T", "golden w", "solvers w"};
  for (std::size_t i = 0; i < 3; ++i) {
    result.checks[i].name = names[i];
    result.checks[i].kind = i < 2 ? "tube" : "solvers";
    result.checks[i].value = 2.0 + static_cast<double>(i), result.checks[i].limit = 1.0;
  }
  result.checks[0].cause = "gain 1.05";
  result.changes = {"by --set: plant.inertia.I3 = 0.6 (was 0.5)"};
  const std::string text = ToCards({result}, {{"s", "dynoproof run s"}}, false);
  EXPECT_THAT(text, HasSubstr("FAILED s: golden w\n"));
  EXPECT_THAT(text, HasSubstr("also   golden T: "));
  EXPECT_THAT(text, HasSubstr("; gain 1.05\n"));
  EXPECT_THAT(text, HasSubstr("FAILED s: solvers w\n"));
  EXPECT_THAT(text, Not(HasSubstr("FAILED s: golden T")));
  EXPECT_THAT(text, HasSubstr("likely changed by --set: plant.inertia.I3 = 0.6 (was 0.5)\n"));
}

TEST(Cards, TellTheValueInTheSignalsUnitWhereItIsKnown) {
  ScenarioResult result = Result("s", score::Verdict::kFail, 1, "");
  result.checks[0].value = 5.4e7;
  result.checks[0].unit = "half-widths";
  result.checks[0].shown = "30 N m off at t = 0.5 s (1e-06 N m allowed)";
  for (const std::string& text : {ToTable({result}, false), ToCards({result}, {{"s", "dynoproof run s"}}, false)}) {
    EXPECT_THAT(text, HasSubstr("30 N m off at t = 0.5 s"));
    EXPECT_THAT(text, Not(HasSubstr("half-widths")));
  }
}

TEST(Json, HasWhatTheCardShowsOnlyWhereItShowsMoreThanTheNumber) {
  ScenarioResult result = Result("s", score::Verdict::kFail, 2, "");
  result.checks[0].value = 5.4e7;
  result.checks[0].shown = "30 N m off at t = 0.5 s (1e-06 N m allowed)";
  const nlohmann::json document = ToJson({result});
  const nlohmann::json& checks = document["scenarios"][0]["checks"];
  ASSERT_EQ(checks.size(), 2u);
  EXPECT_EQ(checks[0].value("shown", ""), result.checks[0].shown);
  EXPECT_EQ(checks[0]["value"], 5.4e7);
  EXPECT_FALSE(checks[1].contains("shown")) << "nothing is invented where value and limit say it";
}

TEST(Markdown, HasTheWorstFirstAndNoMarkupOfOthers) {
  const std::string text = ToMarkdown({Result("fine", score::Verdict::kPass, 1, ""),
                                       Result("short", score::Verdict::kFail, 1, "a|b <script>\nnext line")});
  EXPECT_LT(text.find("| short |"), text.find("| fine |"));
  EXPECT_THAT(text, HasSubstr("a\\|b &lt;script> next line"));
  EXPECT_THAT(text, Not(HasSubstr("left out")));
}

TEST(Markdown, OfAVeryLargeRunStaysSmallAndCountsWhatItLeavesOut) {
  std::vector<ScenarioResult> results;
  for (int i = 0; i < 20'000; ++i) results.push_back(Result(fmt::format("s/{}", i), score::Verdict::kPass, 3, ""));
  results.push_back(Result("s/last", score::Verdict::kFail, 5, "this is why"));
  const std::string text = ToMarkdown(results);
  EXPECT_LT(text.size(), kMebibyte);
  EXPECT_THAT(text, HasSubstr("this is why"));
  EXPECT_THAT(text, HasSubstr("left out for size"));
}

TEST(Markdown, OfOneScenarioWithVeryMuchToSayKeepsIt) {
  const std::string text = ToMarkdown({Result("loud", score::Verdict::kFail, 3000, std::string(100'000, 'x'))});
  EXPECT_LT(text.size(), kMebibyte);
  EXPECT_THAT(text, HasSubstr("| loud | fail | 3000 |"));
  EXPECT_THAT(text, HasSubstr("- **loud**: check 0"));
  EXPECT_THAT(text, HasSubstr("left out for size"));
}

TEST(LowerBound, IsSaidToBeOneWhereverItIsShown) {
  ScenarioResult result = Result("play", score::Verdict::kPass, 0, "");
  result.checks = {score::AtMost("near", "contacts", 0.2, 0.3, "1", "made up"),
                   score::AtLeast("apart", "contacts", 0.484, 0.1, "1", "made up")};
  // 0.2 of 0.3 is nearer to falling than 0.484 is to 0.1.
  EXPECT_EQ(WorstCheck(result)->name, "near");
  result.checks[1].value = 0.11;
  EXPECT_THAT(ToTable({result}, false), HasSubstr("apart: 0.11 (at least 0.1)"));
  EXPECT_THAT(ToMarkdown({result}), HasSubstr("0.11 (at least 0.1)"));
  const nlohmann::json checks = ToJson({result})["scenarios"][0]["checks"];
  EXPECT_EQ(checks[0]["limit_is"], "at_most");
  EXPECT_EQ(checks[1]["limit_is"], "at_least");
  result.checks[1].verdict = result.verdict = score::Verdict::kFail;
  EXPECT_THAT(ToCards({result}, {{"play", "dynoproof run play"}}, false), HasSubstr("0.11 (at least 0.1)"));
}

}  // namespace
}  // namespace dynoproof::reports
