// What must not become a figure of the nightly record: benchmarks that failed, times that are none, other units,
// damage.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sqlite3.h>

#include <map>
#include <nlohmann/json.hpp>

#include "history/watch.h"
#include "tests/support/temp_dir.h"

namespace dynoproof::history {
namespace {

using nlohmann::json;
using ::testing::HasSubstr;
using ::testing::SizeIs;

json Entry(const std::string& name, double time, const std::string& unit = "ns") {
  return {{"name", name}, {"run_name", name}, {"run_type", "iteration"}, {"cpu_time", time}, {"time_unit", unit}};
}

json Google(const std::vector<json>& entries) { return {{"context", json::object()}, {"benchmarks", entries}}; }

std::vector<Reading> Read(const json& document) {
  const Result<std::vector<Reading>> readings = Readings(document);
  EXPECT_TRUE(readings.ok()) << readings.failure().message;
  return *readings;
}

json Covered(const std::string& file, const json& covered, const json& total) {
  return {{"filename", file}, {"line_covered", covered}, {"line_total", total}};
}

json Gcovr(const std::vector<json>& files) { return {{"gcovr/summary_format_version", "0.5"}, {"files", files}}; }

TEST(CoverageReadings, AreSharesOfTheLinesOfEachFolderAndOfAll) {
  std::map<std::string, Reading> readings;
  for (const Reading& reading :
       Read(Gcovr({Covered("engine/trace/csv.cc", 30, 40), Covered("engine/trace/deep/a.cc", 10, 10),
                   Covered("engine/sim/rig.cc", 0, 50)})))
    readings[reading.series] = reading;
  ASSERT_THAT(readings, SizeIs(3));
  EXPECT_EQ(readings["coverage/engine/trace"].value, 80.0);
  EXPECT_EQ(readings["coverage/engine/sim"].value, 0.0);
  EXPECT_EQ(readings["coverage/all"].value, 40.0);
  EXPECT_EQ(readings["coverage/all"].sense, Sense::kMoreIsBetter);
  EXPECT_FALSE(readings["coverage/all"].scatters);
}

TEST(CoverageReadings, OfNoLinesOrOfNoCountsHaveNoValue) {
  for (const json& file : {Covered("engine/trace/a.cc", 0, 0), Covered("engine/trace/a.cc", nullptr, 3),
                           Covered("engine/trace/a.cc", 4, 3), Covered("engine/trace/a.cc", -1, 3)}) {
    for (const Reading& reading : Read(Gcovr({file}))) EXPECT_FALSE(reading.value) << file;
  }
  EXPECT_FALSE(Readings(Gcovr({})).ok()) << "no file at all";
}

/// Less than before, by more than half a point: no matter of time (5), but of what is checked (1).
TEST(CoverageReadings, ThatFallAreAFinding) {
  History history;
  history.nights.resize(3);
  Series series;
  series.name = "coverage/all";
  series.sense = Sense::kMoreIsBetter;
  series.relevant = Read(Gcovr({Covered("engine/sim/a.cc", 9, 10)}))[0].relevant;
  series.nights = {0, 1, 2};
  series.values = {90.0, 89.8, 89.8};
  history.series = {series};
  EXPECT_EQ(Look(history, {}).exit_code, 0);
  history.series[0].values = {90.0, 90.0, 89.0};
  EXPECT_EQ(Look(history, {}).exit_code, 1);
}

TEST(GoogleReadings, OfWhatFailedOrWasSkippedHaveNoValue) {
  json failed = Entry("a", 0.0), lies = Entry("b", 12.0), skipped = Entry("c", 12.0);
  failed["error_occurred"] = lies["error_occurred"] = true;
  failed["error_message"] = "solver failed";
  skipped["skipped"] = true;
  skipped["skip_message"] = "no such machine";
  for (const Reading& reading : Read(Google({failed, lies, skipped, Entry("d", 0.0), Entry("e", -1.0)}))) {
    EXPECT_FALSE(reading.value) << reading.series;
  }
  json fine = Entry("f", 12.0);
  fine["error_occurred"] = false;
  EXPECT_EQ(Read(Google({fine}))[0].value, 12.0);
}

TEST(GoogleReadings, OneRepetitionThatFailedLeavesNoMedian) {
  json failed = Entry("a", 0.0);
  failed["error_occurred"] = true;
  const std::vector<Reading> readings = Read(Google({Entry("a", 10.0), failed, Entry("a", 11.0), Entry("b", 9.0)}));
  ASSERT_THAT(readings, SizeIs(2));
  EXPECT_FALSE(readings[0].value);
  EXPECT_EQ(readings[1].value, 9.0);
}

TEST(GoogleReadings, WhateverSaysThatABenchmarkEndedEarlyIsHeard) {
  for (const json& beside : std::vector<json>{{{"error_message", "solver failed"}},
                                              {{"skip_message", "no such machine"}},
                                              {{"error_occurred", 1}},
                                              {{"skipped", "true"}},
                                              {{"iterations", 0}}}) {
    json entry = Entry("a", 12.0);
    entry.update(beside);
    EXPECT_FALSE(Read(Google({entry}))[0].value) << beside;
  }
  json fine = Entry("a", 12.0);
  fine.update({{"error_occurred", 0}, {"skipped", "false"}, {"error_message", ""}, {"iterations", 1000}});
  EXPECT_EQ(Read(Google({fine}))[0].value, 12.0);
}

TEST(GoogleReadings, FewerRepetitionsThanAnnouncedLeaveNoMedian) {
  std::vector<json> entries(3, Entry("a", 12.0));
  for (json& entry : entries) entry["repetitions"] = 3;
  EXPECT_EQ(Read(Google(entries))[0].value, 12.0);
  entries.pop_back();
  EXPECT_FALSE(Read(Google(entries))[0].value);
}

TEST(GoogleReadings, AMedianOfAPercentageIsNoTime) {
  json percentage = Entry("a", 0.03);
  percentage.update({{"run_type", "aggregate"}, {"aggregate_name", "median"}, {"aggregate_unit", "percentage"}});
  EXPECT_EQ(Read(Google({Entry("a", 12.0), percentage}))[0].value, 12.0);
}

TEST(GoogleReadings, AreInNanosecondsWhateverTheUnit) {
  for (const auto& [time, unit] : {std::pair{1500.0, "ns"}, {1.5, "us"}, {1.5e-3, "ms"}, {1.5e-6, "s"}}) {
    const Reading reading = Read(Google({Entry("a", time, unit)}))[0];
    EXPECT_NEAR(reading.value.value(), 1500.0, 1e-9) << unit;  // round-off of one product
    EXPECT_EQ(reading.unit, "ns");
  }
  EXPECT_FALSE(Read(Google({Entry("a", 1.0, "fortnights")}))[0].value) << "a unit that is none of time";
  const Reading budget = Read(json{{{"name", "b"}, {"value", 1.5}, {"unit", "us"}}})[0];
  EXPECT_NEAR(budget.value.value(), 1500.0, 1e-9);
  EXPECT_TRUE(budget.scatters);
}

TEST(GoogleReadings, AreTheMedianAndNoOtherAggregate) {
  const auto aggregate = [](const std::string& kind, double value) {
    return json{{"name", "a_" + kind},    {"run_name", "a"},   {"run_type", "aggregate"},
                {"aggregate_name", kind}, {"cpu_time", value}, {"time_unit", "us"}};
  };
  const std::vector<json> all = {Entry("a", 9.0, "us"),   Entry("a", 50.0, "us"),    Entry("a", 10.0, "us"),
                                 aggregate("mean", 23.0), aggregate("median", 10.0), aggregate("stddev", 0.0),
                                 aggregate("cv", 0.0)};
  ASSERT_THAT(Read(Google(all)), SizeIs(1));
  EXPECT_EQ(Read(Google(all))[0].value, 10000.0);
  // The single repetitions alone, in any order, say the same.
  EXPECT_EQ(Read(Google({all[2], all[1], all[0]}))[0].value, 10000.0);
  EXPECT_FALSE(Readings(Google({aggregate("mean", 23.0), aggregate("cv", 0.1)})).ok()) << "no reading in it";
}

TEST(ParseResult, TakesWordsForNoNumberAsNothing) {
  const json document = ParseResult(R"({"benchmarks": [{"name": "a \" NaN", "cpu_time": NaN, "x": -Infinity,
      "y": [NaN, Infinity, inf, nan]}]})");
  ASSERT_FALSE(document.is_discarded());
  EXPECT_EQ(document["benchmarks"][0]["name"], "a \" NaN");
  EXPECT_TRUE(document["benchmarks"][0]["cpu_time"].is_null());
  EXPECT_FALSE(Read(document)[0].value);
  EXPECT_TRUE(ParseResult("{").is_discarded());
  EXPECT_TRUE(ParseResult("").is_discarded());
}

class MissingReadings : public ::testing::Test {
 protected:
  MissingReadings() : store_(std::move(*Store::Open(folder_ / "h.sqlite", true))) {}
  static std::string TimeOf(int night) {
    return "2026-11-" + std::string(night < 10 ? "0" : "") + std::to_string(night);
  }
  void Add(int night, const std::vector<Reading>& readings) {
    const Status failed = store_.Add({TimeOf(night) + "T01:00:00Z", "c", "m"}, readings);
    EXPECT_FALSE(failed) << failed->message;
  }
  /// Some scatter around a level.
  static double Level(int night, double level) { return level * (1.0 + 1e-3 * ((7 * night) % 5 - 2)); }
  Watch Look() {
    const Result<History> history = store_.Read("m");
    EXPECT_TRUE(history.ok()) << history.failure().message;
    return history::Look(*history, {});
  }
  void Execute(const std::string& sql) {
    sqlite3* database = nullptr;
    ASSERT_EQ(sqlite3_open((folder_ / "h.sqlite").c_str(), &database), SQLITE_OK);
    EXPECT_EQ(sqlite3_exec(database, sql.c_str(), nullptr, nullptr, nullptr), SQLITE_OK);
    sqlite3_close(database);
  }
  test::TempDir folder_;
  Store store_;
};

TEST_F(MissingReadings, OfABenchmarkThatErrsFailFromThatNightOn) {
  for (int night = 1; night <= 28; ++night) {
    json line = Entry("core/line", night <= 10 ? Level(night, 100.0) : 0.0);
    if (night > 10) line["error_occurred"] = true;
    Add(night, Read(Google({Entry("core/step", Level(night, 100.0)), line})));
    const Watch watch = Look();
    if (night <= 10) {
      EXPECT_THAT(watch.findings, SizeIs(0));
      continue;
    }
    EXPECT_EQ(watch.exit_code, 1) << night;
    ASSERT_FALSE(watch.findings.empty());
    EXPECT_EQ(watch.findings[0].kind, Finding::Kind::kMissing);
    EXPECT_EQ(watch.findings[0].night, 10u) << "the eleventh";
  }
}

TEST_F(MissingReadings, OfABenchmarkThatIsLeftOutFailForTheRecentNights) {
  for (int night = 1; night <= 25; ++night) {
    std::vector<json> entries = {Entry("core/step", Level(night, 100.0))};
    if (night <= 10) entries.push_back(Entry("core/line", Level(night, 100.0)));
    Add(night, Read(Google(entries)));
    EXPECT_EQ(Look().exit_code == 1, night > 10 && night <= 20) << night;
  }
}

TEST_F(MissingReadings, OfABenchmarkThatNeverRanFail) {
  json failed = Entry("core/line", 0.0);
  failed["error_occurred"] = true;
  for (int night = 1; night <= 2; ++night) Add(night, Read(Google({failed})));
  EXPECT_EQ(Look().exit_code, 1);
}

TEST_F(MissingReadings, AChangeOfUnitIsNoChangeOfLevel) {
  // As earlier versions kept them: in the program's own unit, 0 for an error.
  for (int night = 1; night <= 20; ++night) {
    const bool late = night > 10;
    Add(night, {{"time/a", Level(night, late ? 1.5 : 1500.0), late ? "us" : "ns", true, Sense::kLessIsBetter, 0.03},
                {"time/b", Level(night, late ? 2.25 : 1500.0), late ? "us" : "ns", true, Sense::kLessIsBetter, 0.03}});
  }
  const Watch watch = Look();
  ASSERT_THAT(watch.findings, SizeIs(1)) << "of b alone, which became slower by half";
  EXPECT_EQ(watch.findings[0].kind, Finding::Kind::kWorse);
  EXPECT_EQ(watch.findings[0].series, 1u);
  EXPECT_EQ(watch.exit_code, 5);
}

TEST_F(MissingReadings, AnotherQuantityIsAnotherSeries) {
  Add(1, {{"budget/a", 338.0, "instructions", false, Sense::kLessIsBetter, 3.0}});
  Add(2, {{"budget/a", 40.0, "ns", true, Sense::kLessIsBetter, 0.03}});
  const Result<History> history = store_.Read("m");
  ASSERT_THAT(history->series, SizeIs(2));
  EXPECT_EQ(Look().exit_code, 1) << "the count of instructions is gone";
  for (const Series& series : history->series) {
    EXPECT_EQ(series.name, series.unit == "ns" ? "budget/a" : "budget/a [instructions]");
    EXPECT_THAT(series.values, SizeIs(1));
  }
}

TEST_F(MissingReadings, TwoNightsWithinASecondAreTwo) {
  const Night night{"2026-12-31T23:59:59Z", "c", "m"};
  std::vector<std::string> times;
  for (const double value : {1.0, 2.0, 3.0}) {
    const Result<Night> added = store_.AddNight(night, {{"a", value, "1", false, Sense::kNeither, 0.0}});
    ASSERT_TRUE(added.ok()) << added.failure().message;
    times.push_back(added->time);
  }
  EXPECT_EQ(times, (std::vector<std::string>{"2026-12-31T23:59:59Z", "2027-01-01T00:00:00Z", "2027-01-01T00:00:01Z"}));
  EXPECT_EQ(store_.Read("m")->series[0].values, (std::vector<std::optional<double>>{1.0, 2.0, 3.0}));
}

TEST_F(MissingReadings, TextWhereANumberBelongsIsAFault) {
  for (const char* column : {"value", "scatters", "sense", "relevant"}) {
    Add(1, {{"time/a", 1.0, "ns", true, Sense::kLessIsBetter, 0.03}});
    ASSERT_TRUE(store_.Read("m").ok());
    Execute(std::string("UPDATE reading SET ") + column + " = 'fast'");
    const Result<History> history = store_.Read("m");
    ASSERT_FALSE(history.ok()) << column;
    EXPECT_EQ(history.failure().exit_code, 2);
    for (const std::string& text : {std::string("fast"), std::string(column), std::string("time/a"), TimeOf(1)})
      EXPECT_THAT(history.failure().message, HasSubstr(text));
  }
}

}  // namespace
}  // namespace dynoproof::history
