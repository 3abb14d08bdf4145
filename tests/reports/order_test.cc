// The order of the worst runs on a sweep page, and the text for a series without any reading on the trend page.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "campaign/summary.h"
#include "reports/trend_page.h"

namespace dynoproof::reports {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::Not;

TEST(WorstRuns, StandByVerdictThenByWhatTheyTakeOfTheirLimit) {
  using score::Verdict;
  std::vector<campaign::Row> rows(7);
  const std::vector<std::pair<Verdict, double>> made = {
      {Verdict::kFail, 1.2},   {Verdict::kPass, 0.9}, {Verdict::kInconclusive, 9.0}, {Verdict::kFail, 80.0},
      {Verdict::kBroken, NAN}, {Verdict::kFail, NAN}, {Verdict::kFail, 80.0}};
  for (std::size_t i = 0; i < rows.size(); ++i) {
    rows[i].run = static_cast<std::int64_t>(i);
    rows[i].verdict = made[i].first;
    rows[i].used = made[i].second;
  }
  EXPECT_THAT(campaign::WorstRuns(rows, 10), ElementsAre(4, 5, 3, 6, 0, 2));
  EXPECT_THAT(campaign::WorstRuns(rows, 3), ElementsAre(4, 5, 3));
}

TEST(TrendPage, SaysOfASeriesThatNeverHadAReadingThatItHadNone) {
  history::History history;
  history.nights = {{}, {}};
  history::Series series;
  series.name = "time/never";
  series.scatters = true;
  series.nights = {0, 1};
  series.values = {std::nullopt, std::nullopt};
  history.series = {series};
  const std::string page = TrendPage(history, Look(history, {}));
  EXPECT_THAT(page, HasSubstr("no reading, nor ever one"));
  EXPECT_THAT(page, Not(HasSubstr("last was nan")));
}

}  // namespace
}  // namespace dynoproof::reports
