// The nightly record: what is taken out of results, that it comes back from the file, and what counts as a finding.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <nlohmann/json.hpp>

#include "history/watch.h"
#include "tests/support/temp_dir.h"

namespace dynoproof::history {
namespace {

using nlohmann::json;
using ::testing::HasSubstr;
using ::testing::SizeIs;

json RunDocument(double value) {
  return {{"exit", 0},
          {"scenarios",
           {{{"id", "r2r/a"},
             {"checks", {{{"name", "golden T"}, {"value", value}, {"limit", 1.0}, {"unit", "1"}}}},
             {"figures", {{"peak", {{"value", 12.0}, {"unit", "N m"}}}}},
             {"counters", {{"steps", 1000}}}}}}};
}

Night NightOf(int day, const std::string& machine = "m") {
  return {"2026-03-" + std::string(day < 10 ? "0" : "") + std::to_string(day) + "T02:00:00Z",
          "commit" + std::to_string(day), machine};
}

class HistoryFile : public ::testing::Test {
 protected:
  Store Open() {
    Result<Store> store = Store::Open(folder_ / "h.sqlite", true);
    EXPECT_TRUE(store.ok());
    return std::move(*store);
  }
  test::TempDir folder_;
};

TEST(Readings, OfARunHaveScoresFiguresAndCounters) {
  const Result<std::vector<Reading>> readings = Readings(RunDocument(0.3));
  ASSERT_TRUE(readings.ok());
  ASSERT_THAT(*readings, SizeIs(3));
  EXPECT_EQ((*readings)[0].series, "score/r2r/a/golden T");
  EXPECT_EQ((*readings)[0].value, 0.3);
  EXPECT_EQ((*readings)[0].sense, Sense::kLessIsBetter);
  EXPECT_DOUBLE_EQ((*readings)[0].relevant, 0.05);
  EXPECT_EQ((*readings)[1].series, "figure/r2r/a/peak");
  EXPECT_EQ((*readings)[2].series, "counter/r2r/a/steps");
}

TEST(Readings, OfNumbersThatAreNoneHaveNoValue) {
  json document = RunDocument(0.3);
  document["scenarios"][0]["checks"][0]["value"] = nullptr;
  EXPECT_FALSE((*Readings(document))[0].value.has_value());
}

TEST(Readings, OfBenchmarksAndBudgetsScatterOrNot) {
  const auto budget = Readings(json::parse(
      R"([{"name": "core", "value": 338.9, "unit": "instructions"}, {"name": "t", "value": 40, "unit": "ns"}])"));
  ASSERT_TRUE(budget.ok());
  EXPECT_FALSE((*budget)[0].scatters);
  EXPECT_TRUE((*budget)[1].scatters);
  const auto google = Readings(json::parse(R"({"context": {}, "benchmarks": [
      {"name": "Step_median", "run_name": "Step", "run_type": "aggregate", "aggregate_name": "median", "cpu_time": 41.0, "time_unit": "ns"},
      {"name": "Step_stddev", "run_name": "Step", "run_type": "aggregate", "aggregate_name": "stddev", "cpu_time": 1.0, "time_unit": "ns"}]})"));
  ASSERT_TRUE(google.ok());
  ASSERT_THAT(*google, SizeIs(1));
  EXPECT_EQ((*google)[0].series, "time/Step");
}

TEST(Readings, RefusesWhatItDoesNotKnow) {
  for (const char* text : {"{}", "[]", "[1]", R"({"scenarios": [{"id": 1}]})", R"({"benchmarks": []})", "3"}) {
    const auto readings = Readings(json::parse(text));
    ASSERT_FALSE(readings.ok()) << text;
    EXPECT_EQ(readings.failure().exit_code, 2) << text;
  }
}

TEST_F(HistoryFile, ComesBackByMachineClassAndInOrder) {
  Store store = Open();
  for (const int day : {2, 1, 3}) {
    EXPECT_FALSE(store.Add(NightOf(day), {{"a", static_cast<double>(day), "ns", true, Sense::kLessIsBetter, 0.03}}));
  }
  EXPECT_FALSE(store.Add(NightOf(4, "other"), {{"a", 9.0, "ns", true, Sense::kLessIsBetter, 0.03}}));
  EXPECT_FALSE(store.Add(NightOf(3), {{"b", std::nullopt, "1", false, Sense::kNeither, 0.0}}));  // joins that night
  const Result<History> history = store.Read("m");
  ASSERT_TRUE(history.ok());
  ASSERT_THAT(history->nights, SizeIs(3));
  ASSERT_THAT(history->series, SizeIs(2));
  EXPECT_EQ(history->series[0].values, (std::vector<std::optional<double>>{1.0, 2.0, 3.0}));
  EXPECT_EQ(history->series[0].unit, "ns");
  EXPECT_FALSE(history->series[1].values[0].has_value());
  EXPECT_EQ(store.Read("")->nights[0].machine, "other") << "the class of the newest night";
}

TEST_F(HistoryFile, AddingTwiceChangesNothing) {
  Store store = Open();
  for (int i = 0; i < 2; ++i) EXPECT_FALSE(store.Add(NightOf(1), *Readings(RunDocument(0.3))));
  const Result<History> history = store.Read("m");
  EXPECT_THAT(history->nights, SizeIs(1));
  EXPECT_THAT(history->series[0].values, SizeIs(1));
}

TEST_F(HistoryFile, WhatIsNoHistoryIsRefused) {
  std::ofstream(folder_ / "text.sqlite")
      << "this is no database, but long enough to be looked at as one ..............";
  const auto text = Store::Open(folder_ / "text.sqlite", true);
  ASSERT_FALSE(text.ok());
  EXPECT_EQ(text.failure().exit_code, 2);
  const auto missing = Store::Open(folder_ / "none.sqlite", false);
  ASSERT_FALSE(missing.ok());
  EXPECT_THAT(missing.failure().message, HasSubstr("history add"));
  EXPECT_EQ(missing.failure().exit_code, 2);
}

History Nights(const std::string& series, const std::vector<std::optional<double>>& values, Sense sense,
               bool scatters = false) {
  History history;
  for (std::size_t i = 0; i < values.size(); ++i) history.nights.push_back(NightOf(static_cast<int>(i) + 1));
  Series one{.name = series, .scatters = scatters, .sense = sense, .relevant = 0.05};
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (!values[i]) continue;
    one.nights.push_back(i);
    one.values.push_back(values[i]);
  }
  history.series = {one};
  return history;
}

TEST(Watch, AWorseScoreAndAWorseCostHaveTheirExitCodes) {
  EXPECT_EQ(Look(Nights("score/a/b", {0.1, 0.1, 0.3}, Sense::kLessIsBetter), {}).exit_code, 1);
  EXPECT_EQ(Look(Nights("budget/core", {339.0, 350.0}, Sense::kLessIsBetter), {}).exit_code, 5);
  EXPECT_EQ(Look(Nights("score/a/b", {0.3, 0.1}, Sense::kLessIsBetter), {}).exit_code, 0);
  EXPECT_EQ(Look(Nights("bench/a/simulated_s_per_s", {600.0, 500.0}, Sense::kMoreIsBetter), {}).exit_code, 5);
  EXPECT_EQ(Look(Nights("figure/a/b", {1.0, 2.0}, Sense::kNeither), {}).exit_code, 0);
  EXPECT_EQ(Look(Nights("figure/a/b", {1.0, 2.0}, Sense::kNeither), {}).findings[0].kind, Finding::Kind::kChanged);
}

TEST(Watch, WhatWasMendedOrIsLongAgoIsNoFinding) {
  EXPECT_EQ(Look(Nights("score/a/b", {0.1, 0.3, 0.1}, Sense::kLessIsBetter), {}).exit_code, 0);
  std::vector<std::optional<double>> values(20, 0.3);
  values[0] = 0.1;
  WatchOptions options;
  EXPECT_EQ(Look(Nights("score/a/b", values, Sense::kLessIsBetter), options).exit_code, 0);
  options.recent = 30;
  EXPECT_EQ(Look(Nights("score/a/b", values, Sense::kLessIsBetter), options).exit_code, 1);
}

TEST(Watch, AReadingThatIsGoneIsAFinding) {
  const auto gone = Look(Nights("score/a/b", {0.1, 0.1, std::nullopt}, Sense::kLessIsBetter), {});
  EXPECT_EQ(gone.exit_code, 1);
  EXPECT_EQ(gone.findings[0].kind, Finding::Kind::kMissing);
}

TEST(Watch, NothingComparedIsUndecided) {
  EXPECT_EQ(Look(Nights("score/a/b", {0.1}, Sense::kLessIsBetter), {}).exit_code, 4);
  EXPECT_EQ(Look(History{}, {}).exit_code, 4);
  EXPECT_EQ(Look(Nights("time/a", {1.0, 1.1, 1.0}, Sense::kLessIsBetter, true), {}).exit_code, 4);
}

}  // namespace
}  // namespace dynoproof::history
