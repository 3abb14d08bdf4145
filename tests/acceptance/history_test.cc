// `dynoproof history` and [record] from outside.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/program.h"
#include "trace/csv_write.h"
#include "trace/trace_io.h"

namespace dynoproof::test {
namespace {

using ::testing::HasSubstr;

std::string Budgets(double instructions) {
  return "[{\"name\": \"core\", \"value\": " + std::to_string(instructions) +
         ", \"limit\": 342.3, \"unit\": \"instructions\", \"verdict\": \"pass\"}]";
}

TEST(HistoryFromOutside, KeepsShowsAndFindsWhatGotWorse) {
  Bench bench;
  EXPECT_EQ(bench.Call({"history", "check", "--db", "h.sqlite"}).exit, 2) << "there is none yet";
  for (int night = 1; night <= 6; ++night) {
    bench.Write("budgets.json", Budgets(night < 5 ? 338.9 : 349.0));
    const Outcome add =
        bench.Call({"history", "add", "budgets.json", "--db", "h.sqlite", "--machine", "m", "--commit",
                    "c" + std::to_string(night), "--time", "2026-03-0" + std::to_string(night) + "T02:00:00Z"});
    ASSERT_EQ(add.exit, 0) << add.Both();
    if (night == 5) continue;
    EXPECT_EQ(bench.Call({"history", "check", "--db", "h.sqlite"}).exit, night == 1 ? 4 : night < 5 ? 0 : 5);
  }
  const Outcome check =
      bench.Call({"history", "check", "--db", "h.sqlite", "--html", "trend.html", "--json", "c.json"});
  EXPECT_EQ(check.exit, 5) << check.Both();
  EXPECT_THAT(check.Both(), HasSubstr("commit c5"));
  EXPECT_THAT(ReadBytes(bench / "trend.html"), HasSubstr("budget/core"));
  const auto document = nlohmann::json::parse(ReadBytes(bench / "c.json"));
  EXPECT_EQ(document["findings"][0]["kind"], "worse");
  EXPECT_EQ(document["findings"][0]["commit"], "c5");
  const Outcome show = bench.Call({"history", "show", "--db", "h.sqlite", "--series", "core"});
  EXPECT_EQ(show.exit, 0);
  EXPECT_THAT(show.Both(), HasSubstr("▁▁▁▁██"));
}

TEST(HistoryFromOutside, NamesTheCommandThatFindsTheCommit) {
  Bench bench;
  const auto run = [](double value) {
    return nlohmann::json{{"exit", 0},
                          {"diagnostics", nlohmann::json::array()},
                          {"scenarios",
                           {{{"id", "family/line"},
                             {"title", "a line"},
                             {"verdict", "pass"},
                             {"trace", ""},
                             {"checks", nlohmann::json::array()},
                             {"figures", {{"resonance_1_hz", {{"value", value}, {"unit", "Hz"}}}}}}}}}
        .dump();
  };
  for (int night = 1; night <= 3; ++night) {
    bench.Write("run.json", run(night < 3 ? 97.38 : 96.87));
    const Outcome add =
        bench.Call({"history", "add", "run.json", "--db", "h.sqlite", "--machine", "m", "--commit",
                    "c" + std::to_string(night), "--time", "2026-03-0" + std::to_string(night) + "T02:00:00Z"});
    ASSERT_EQ(add.exit, 0) << add.Both();
  }
  const Outcome check = bench.Call({"history", "check", "--db", "h.sqlite", "--json", "c.json"});
  EXPECT_THAT(check.Both(), HasSubstr("dynoproof bisect family/line --good c2 --bad c3"));
  EXPECT_EQ(nlohmann::json::parse(ReadBytes(bench / "c.json"))["findings"][0]["bisect"],
            "dynoproof bisect family/line --good c2 --bad c3");
}

TEST(HistoryFromOutside, TakesAllFilesOrNone) {
  Bench bench;
  bench.Write("good.json", Budgets(1.0));
  bench.Write("bad.json", "{");
  bench.Write("other.json", "{\"a\": 1}");
  const Outcome add = bench.Call(
      {"history", "add", "good.json", "bad.json", "other.json", "none.json", "--time", "noon", "--db", "h.sqlite"});
  EXPECT_EQ(add.exit, 2);
  for (const char* text : {"bad.json", "other.json", "none.json", "--time noon"})
    EXPECT_THAT(add.Both(), HasSubstr(text));
  EXPECT_FALSE(std::filesystem::exists(bench / "h.sqlite"));
}

/// A scenario with a record made from its own run, one output scaled by `gain`.
class MeasurementAsCheck : public ::testing::Test {
 protected:
  void Record(double gain) {
    ASSERT_EQ(bench_.Call({"run", "line.toml"}).exit, 0);
    const Result<trace::Trace> trace = trace::ReadTrace(bench_ / "out/line.h5");
    ASSERT_TRUE(trace.ok());
    std::vector<trace::Column> columns = {{.name = "t", .unit = "s", .values = trace->time}};
    for (const char* name : {"T_airgap", "T_shaft", "omega_1"}) {
      columns.push_back({.name = name, .unit = trace->Find(name)->unit, .values = trace->Find(name)->values});
    }
    for (double& value : columns[2].values) value *= gain;
    ASSERT_FALSE(trace::WriteCsv(bench_ / "measured.csv", columns));
    Scenario("");
    const std::string fault = bench_.Call({"validate", "measured.toml"}).Both();
    const std::size_t at = fault.find("add hash = \"");
    ASSERT_NE(at, std::string::npos) << fault;
    hash_ = fault.substr(at + 12, 64);
    Scenario(hash_);
  }
  void Scenario(const std::string& hash, const std::string& more = "") {
    std::string record = "\n[record]\nfile = \"measured.csv\"\nnrmse = { T_shaft = 0.02, omega_1 = 0.02 }\n" + more;
    if (!hash.empty()) record.insert(record.find("nrmse"), "hash = \"" + hash + "\"\n");
    bench_.Write("measured.toml", Bench::kLine + record);
  }
  int Run(const std::vector<std::string>& more = {}) {
    std::vector<std::string> arguments = {"run", "measured.toml", "--json", "r.json"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    said_ = bench_.Call(arguments);
    return said_.exit;
  }
  Bench bench_;
  std::string hash_;
  Outcome said_;
};

TEST_F(MeasurementAsCheck, HoldsAndFails) {
  Record(1.0);
  EXPECT_EQ(Run(), 0) << said_.Both();
  const auto checks = nlohmann::json::parse(ReadBytes(bench_ / "r.json"))["scenarios"][0]["checks"];
  int records = 0;
  for (const auto& check : checks) records += check["kind"] == "record" ? 1 : 0;
  EXPECT_EQ(records, 2);
  EXPECT_GT(checks.size(), 2u) << "the scenario's own checks count as well";
  Record(1.1);
  EXPECT_EQ(Run(), 1);
  EXPECT_THAT(said_.Both(), HasSubstr("record T_shaft"));
}

TEST_F(MeasurementAsCheck, AMissingOrChangedRecordFails) {
  Record(1.0);
  bench_.Write("measured.csv", ReadBytes(bench_ / "measured.csv") + "\n");
  EXPECT_EQ(Run(), 1);
  // Which file, what was expected, what there is, what to do.
  for (const std::string& text :
       std::vector<std::string>{"\"measured.csv\" is another one", "expects the SHA-256 " + hash_.substr(0, 64),
                                "the file has ", "write hash = \""}) {
    EXPECT_THAT(said_.Both(), HasSubstr(text));
  }
  EXPECT_EQ(bench_.Call({"validate", "measured.toml"}).exit, 2) << "validate looks, too";
  std::filesystem::remove(bench_ / "measured.csv");
  EXPECT_EQ(Run(), 1);
  EXPECT_THAT(said_.Both(), HasSubstr("missing"));
  const Outcome validated = bench_.Call({"validate", "measured.toml"});
  EXPECT_EQ(validated.exit, 2);
  EXPECT_THAT(validated.Both(), HasSubstr("\"measured.csv\" is missing"));
  EXPECT_THAT(validated.Both(), HasSubstr("measured.toml:"));
}

TEST_F(MeasurementAsCheck, AnAcceptedGapExpires) {
  Record(1.1);
  Scenario(hash_,
           "[record.accepted.T_shaft]\nnrmse = 0.2\nreason = \"transducer not calibrated\"\nuntil = \"2026-06-30\"\n");
  EXPECT_EQ(Run({"--today", "2026-06-30"}), 0) << said_.Both();
  EXPECT_EQ(Run({"--today", "2026-07-01"}), 1);
  EXPECT_THAT(said_.Both(), HasSubstr("accepted until 2026-06-30"));
  Scenario(hash_, "[record.accepted.T_shaft]\nnrmse = 0.2\nreason = \" \"\nuntil = \"soon\"\n");
  EXPECT_EQ(Run(), 2);
  EXPECT_THAT(said_.Both(), HasSubstr("soon"));
  EXPECT_THAT(said_.Both(), HasSubstr("reason"));
}

}  // namespace
}  // namespace dynoproof::test
