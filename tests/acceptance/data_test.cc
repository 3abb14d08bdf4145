// `dynoproof run --data` from outside: a record made from a trace must come back, and bad records must not get through.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "tests/support/program.h"
#include "trace/csv_write.h"
#include "trace/trace_io.h"

namespace dynoproof::test {
namespace {

using ::testing::HasSubstr;
using trace::Column;

/// The run of line.toml as columns t, T_airgap, T_shaft, omega_1.
class Data : public ::testing::Test {
 protected:
  void SetUp() override {
    ASSERT_EQ(bench_.Call({"run", "line.toml"}).exit, 0);
    const Result<trace::Trace> trace = trace::ReadTrace(bench_ / "out/line.h5");
    ASSERT_TRUE(trace.ok());
    columns_.push_back({.name = "t", .unit = "s", .values = trace->time});
    for (const char* name : {"T_airgap", "T_shaft", "omega_1"}) {
      columns_.push_back({.name = name, .unit = trace->Find(name)->unit, .values = trace->Find(name)->values});
    }
    // Another excitation in the scenario: what comes back then comes from the record.
    std::string text = Bench::kLine;
    text.replace(text.find("amplitude = 100.0"), 17, "amplitude = 3.0");
    bench_.Write("line.toml", text);
  }
  void Write(const std::string& name = "record.csv") { ASSERT_FALSE(trace::WriteCsv(bench_ / name, columns_)); }
  Outcome Run(const std::vector<std::string>& more = {}) {
    std::vector<std::string> arguments = {"run", "line.toml", "--data", "record.csv", "--json", "result.json"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return bench_.Call(arguments);
  }
  nlohmann::json Scenario() { return nlohmann::json::parse(ReadBytes(bench_ / "result.json"))["scenarios"][0]; }
  void EachValue(std::size_t column, const std::function<double(double)>& change) {
    for (double& value : columns_[column].values) value = change(value);
  }

  Bench bench_;
  std::vector<Column> columns_;
};

TEST_F(Data, ComesBack) {
  Write();
  const Outcome run = Run();
  EXPECT_EQ(run.exit, 0) << run.Both();
  const nlohmann::json result = Scenario();
  ASSERT_EQ(result["checks"].size(), 2u);
  // Decimals that read back the same, the same inputs, the same solver: only time stamps can round.
  for (const char* name : {"T_shaft.nrmse", "omega_1.nrmse"})
    EXPECT_LT(result["figures"][name]["value"], 1e-12) << name;
  const auto trace = trace::ReadTrace(bench_ / "out/line.h5");
  ASSERT_TRUE(trace.ok());
  EXPECT_EQ(trace->Find("T_airgap")->values, columns_[1].values) << "the trace holds what drove the run";
  EXPECT_EQ(trace->time.size(), 501u);
}

TEST_F(Data, ComesBackThroughAMap) {
  EachValue(0, [](double t) { return 1e3 * t + 5000.0; });     // milliseconds, not from 0
  EachValue(1, [](double torque) { return -1e-3 * torque; });  // kN m, sign turned
  EachValue(3, [](double speed) { return speed * 30.0 / M_PI; });
  columns_[0] = {.name = "stamp", .unit = "", .values = columns_[0].values};
  columns_[1].name = "M (airgap)";
  columns_[1].unit = columns_[2].unit = columns_[3].unit = "";
  columns_[2].name = "flange";
  columns_[3].name = "n";
  for (Column& column : columns_) column.values.resize(450);
  Write();
  bench_.Write("map.toml",
               "time = { column = \"stamp\", unit = \"ms\" }\nrows = [0, 400]\n"
               "[input.T_airgap]\ncolumn = \"M (airgap)\"\nunit = \"kN m\"\nsign = -1\n"
               "[output.T_shaft]\ncolumn = \"flange\"\n[output.omega_1]\ncolumn = \"n\"\nunit = \"1/min\"\n");
  const Outcome run = Run({"--map", "map.toml"});
  EXPECT_EQ(run.exit, 0) << run.Both();
  EXPECT_THAT(run.err, HasSubstr("turns")) << "1/min counts turns, and the reader is told";
  // Two conversions round, by some 1e-16; the run carries that along.
  for (const char* name : {"T_shaft.nrmse", "omega_1.nrmse"})
    EXPECT_LT(Scenario()["figures"][name]["value"], 1e-9) << name;
  EXPECT_EQ(trace::ReadTrace(bench_ / "out/line.h5")->time.size(), 400u) << "the rows asked for";
}

TEST_F(Data, ComesBackByRateWithoutATimeColumn) {
  columns_.erase(columns_.begin());
  Write();
  const Outcome without = Run();
  EXPECT_EQ(without.exit, 2);
  EXPECT_THAT(without.err, HasSubstr("rate_hz"));
  bench_.Write("map.toml",
               "time = { rate_hz = 10000.0 }\n[input.T_airgap]\ncolumn = \"T_airgap\"\n[output.T_shaft]\ncolumn = "
               "\"T_shaft\"\n");
  EXPECT_EQ(Run({"--map", "map.toml"}).exit, 0);
}

/// A step of no whole nanoseconds, and time stamps rounded to microseconds: every sample must act in its own period.
TEST_F(Data, ComesBackAtAnAwkwardRate) {
  ASSERT_EQ(bench_
                .Call({"run", "line.toml", "--set", "run.period_s=0.001638405", "--set", "run.duration_s=1.638405",
                       "--set", "input.T_airgap.source.amplitude=50.0"})
                .exit,
            0);
  const auto trace = trace::ReadTrace(bench_ / "out/line.h5");
  ASSERT_TRUE(trace.ok());
  for (std::size_t c = 1; c < columns_.size(); ++c) columns_[c].values = trace->Find(columns_[c].name)->values;
  columns_[0].values.clear();
  for (std::size_t i = 0; i < trace->time.size(); ++i) {
    columns_[0].values.push_back(std::round(1e6 * static_cast<double>(i) / 610.35) * 1e-6);
  }
  Write();
  const Outcome rounded = Run();
  EXPECT_EQ(rounded.exit, 0) << rounded.Both();
  // What is left is that the outputs are compared at the rounded stamps: some 1e-3 of a sample.
  EXPECT_LT(Scenario()["figures"]["omega_1.nrmse"]["value"], 1e-2);
  columns_.erase(columns_.begin());
  Write();
  bench_.Write("map.toml",
               "time = { rate_hz = 610.35 }\n[input.T_airgap]\ncolumn = \"T_airgap\"\n[output.omega_1]\ncolumn = "
               "\"omega_1\"\n");
  const Outcome exact = Run({"--map", "map.toml"});
  EXPECT_EQ(exact.exit, 0) << exact.Both();
  EXPECT_LT(Scenario()["figures"]["omega_1.nrmse"]["value"], 1e-3);
}

/// An analogue torque up to 400 Hz, sampled at 2 kHz: held or joined by straight lines it is another torque.
TEST_F(Data, OfABandLimitedInputIsReplayedAsThat) {
  ASSERT_EQ(
      bench_.Call({"run", "line.toml", "--set", "run.period_s=1e-5", "--set", "input.T_airgap.source.amplitude=50.0"})
          .exit,
      0);
  const auto trace = trace::ReadTrace(bench_ / "out/line.h5");
  ASSERT_TRUE(trace.ok());
  ASSERT_EQ(trace->time.size(), 5001u);
  columns_[0].values.clear();
  for (std::size_t i = 0; i < trace->time.size(); i += 50) columns_[0].values.push_back(trace->time[i]);
  for (std::size_t c = 1; c < columns_.size(); ++c) {
    columns_[c].values.clear();
    for (std::size_t i = 0; i < trace->time.size(); i += 50)
      columns_[c].values.push_back(trace->Find(columns_[c].name)->values[i]);
  }
  Write();
  std::map<std::string, double> error;
  for (const char* between : {"hold", "linear", "band_limited"}) {
    std::string text = Bench::kLine;
    const std::size_t at = text.find("source = { type");
    text.replace(at, text.find('\n', at) - at,
                 std::string("source = { type = \"replay\", times_s = [0.0, 1.0], values = [0.0, 0.0], "
                             "interpolation = \"") +
                     between + "\" }");
    bench_.Write("line.toml", text);
    Run();
    error[between] = Scenario()["figures"]["T_shaft.nrmse"]["value"];
  }
  EXPECT_LT(error["band_limited"], 0.005);  // 0.0035: the end of the record, and ticks of 100 us
  EXPECT_GT(error["linear"], 0.01);         // 0.0145
  EXPECT_GT(error["hold"], 0.1);            // 0.17
}

TEST_F(Data, MustHaveEveryOutputThatTheScenarioLimits) {
  bench_.Write("line.toml", Bench::kLine + std::string("\n[record]\nnrmse = { T_shaft = 0.1, omega_1 = 0.1 }\n"));
  columns_.pop_back();
  Write();
  const Outcome run = Run();
  EXPECT_EQ(run.exit, 1) << run.Both();
  EXPECT_THAT(run.out, HasSubstr("the record does not have it"));
}

TEST_F(Data, SaysHowLongTheRunLasts) {
  Write();
  const Outcome run = Run({"--set", "run.duration_s=0.01"});
  EXPECT_EQ(run.exit, 2) << run.Both();
  EXPECT_THAT(run.err, HasSubstr("rows"));
}

TEST_F(Data, ComesBackFromATraceAsRecord) {
  ASSERT_EQ(
      bench_.Call({"run", "line.toml", "--set", "input.T_airgap.source.amplitude=50.0", "--out", "measured"}).exit, 0);
  const Outcome run = bench_.Call({"run", "line.toml", "--data", "measured/line.h5"});
  EXPECT_EQ(run.exit, 0) << run.Both();
}

TEST_F(Data, FailsWhenItDisagrees) {
  EachValue(2, [](double torque) { return 1.5 * torque; });
  Write();
  const Outcome run = Run();
  EXPECT_EQ(run.exit, 1) << run.Both();
  EXPECT_THAT(run.out, HasSubstr("record T_shaft"));
}

TEST_F(Data, OfAFewSamplesIsUndecided) {
  for (Column& column : columns_) column.values.resize(3);
  Write();
  const Outcome run = Run();
  EXPECT_EQ(run.exit, 4) << run.Both();
  EXPECT_THAT(run.out, HasSubstr("3 samples are too few to compare with a simulation (at least 30)"));
  for (const nlohmann::json& check : Scenario()["checks"]) EXPECT_EQ(check["verdict"], "inconclusive") << check;
  const Outcome fit =
      bench_.Call({"identify", "line.toml", "--data", "record.csv", "--free", "plant.inertia.I3", "--starts", "1"});
  EXPECT_EQ(fit.exit, 4) << fit.Both();
  EXPECT_THAT(fit.err, HasSubstr("3 samples are too few"));
}

TEST_F(Data, OfInputsAloneIsUndecided) {
  columns_.resize(2);
  Write();
  std::filesystem::remove(bench_ / "out/line.h5");
  const Outcome run = Run();
  EXPECT_EQ(run.exit, 4) << run.Both();
  EXPECT_EQ(Scenario()["verdict"], "inconclusive");
  EXPECT_TRUE(std::filesystem::exists(bench_ / "out/line.h5")) << "the trace is written all the same";
}

TEST_F(Data, OfOutputsAloneSaysWhatDroveTheRun) {
  columns_.erase(columns_.begin() + 1);
  Write();
  const Outcome run = Run();
  EXPECT_NE(run.exit, 0) << "another excitation cannot give the record's outputs";
  EXPECT_THAT(run.err, HasSubstr("T_airgap")) << "the reader must be told that nothing in the record drives it";
}

TEST_F(Data, WithNaNIsRefusedWithPlaceAndCount) {
  columns_[2].values[17] = columns_[2].values[18] = std::nan("");
  Write();
  const Outcome run = Run();
  EXPECT_EQ(run.exit, 2);
  EXPECT_THAT(run.err, HasSubstr("T_shaft"));
  EXPECT_THAT(run.err, HasSubstr("2 values"));
  EXPECT_THAT(run.err, HasSubstr("17"));
}

TEST_F(Data, WithTimeThatFallsIsRefused) {
  columns_[0].values[30] = columns_[0].values[28];
  Write();
  const Outcome run = Run();
  EXPECT_EQ(run.exit, 2);
  EXPECT_THAT(run.err, HasSubstr("30"));
}

TEST_F(Data, OfAnotherQuantityIsRefused) {
  columns_[2].unit = "rad/s";
  Write();
  const Outcome run = Run();
  EXPECT_EQ(run.exit, 2);
  EXPECT_THAT(run.err, HasSubstr("\"T_shaft\" is in \"rad/s\""));
}

TEST_F(Data, WithFaultyMapsIsRefused) {
  Write();
  for (const auto& [map, answer] : std::vector<std::pair<std::string, std::string>>{
           {"[output.T_shaf]\ncolumn = \"T_shaft\"\n", "map.toml:1:9: error: the scenario has no output \"T_shaf\""},
           {"[output.T_shaft]\ncolumn = \"T_shft\"\n", "did you mean \"T_shaft\"?"},
           {"[output.T_shaft]\ncolum = \"T_shaft\"\n", "did you mean \"column\"?"},
           {"[output.T_shaft]\ncolumn = \"T_shaft\"\nunit = \"Pa\"\n", "is in \"Pa\""},
           {"[output.T_shaft]\ncolumn = \"T_shaft\"\nunit = \"Nmm2x\"\n", "unknown unit"},
           {"[output.T_shaft]\ncolumn = \"T_shaft\"\nsign = 2\n", "sign"},
           {"[output.T_shaft]\ncolumn = \"T_shaft\"\nsign = 0.5\n", "1 or -1"},
           {"rows = [5, 2]\n[output.T_shaft]\ncolumn = \"T_shaft\"\n", "rows"},
           {"rows = [600, 700]\n[output.T_shaft]\ncolumn = \"T_shaft\"\n", "rows"},
           {"tiem = { column = \"t\" }\n[output.T_shaft]\ncolumn = \"T_shaft\"\n", "did you mean \"time\"?"},
           {"time = { column = \"t\", unit = \"Hz\" }\n[output.T_shaft]\ncolumn = \"T_shaft\"\n", "no unit of time"},
           {"time = \"tt\"\n[output.T_shaft]\ncolumn = \"T_shaft\"\n", "no column \"tt\""},
           {"time = 3\n[output.T_shaft]\ncolumn = \"T_shaft\"\n", "time"},
           {"[input.T_airgap]\ncolumn = \"T_airgap\"\nbetween = \"hold\"\n", "held"},
           {"[output.T_shaft]\ncolumn = \"T_shaft\"\nbetween = \"held\"\n", "belongs to an input"},
           {"output = 3\n", "output"},
           {"", "record.csv"}}) {
    bench_.Write("map.toml", map);
    const Outcome run = Run({"--map", "map.toml"});
    EXPECT_EQ(run.exit, 2) << map << run.Both();
    EXPECT_THAT(run.err, HasSubstr(answer)) << map;
  }
}

TEST_F(Data, ThatIsNotThereOrNoRecordIsRefused) {
  EXPECT_EQ(Run().exit, 2);
  bench_.Write("record.csv", "");
  EXPECT_EQ(Run().exit, 2);
  bench_.Write("record.csv", "t,T_airgap\n");
  EXPECT_EQ(Run().exit, 2);
  bench_.Write("record.csv", "t,wrong\n0,1\n1,2\n2,3\n");
  const Outcome run = Run();
  EXPECT_EQ(run.exit, 2);
  EXPECT_THAT(run.err, HasSubstr("the scenario has: T_airgap"));
}

TEST_F(Data, DrivesOneScenarioOnly) {
  Write();
  bench_.Write("other.toml", Bench::kLine);
  EXPECT_EQ(Run({"other.toml"}).exit, 2);
}

}  // namespace
}  // namespace dynoproof::test
