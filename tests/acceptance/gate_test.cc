// What a gate lets through, from outside: traces of other rasters, tolerances of nothing, modes of a clutch, a
// benchmark that errs, a torque that meets the friction's limit.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "tests/acceptance/spoil.h"
#include "tests/support/program.h"
#include "trace/trace_io.h"

namespace dynoproof::test {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

class OtherRasters : public ::testing::Test {
 protected:
  /// A sine of one hertz, its gain 1 or another, at these steps in turn.
  void Trace(const char* name, std::vector<double> steps_s, double end_s, double gain = 1.0, double spike_at = -1.0) {
    trace::Trace trace;
    trace::Signal signal{"T", "N m"};
    double t = 0.0;
    for (std::size_t i = 0; t <= end_s + 1e-9; t += steps_s[i++ % steps_s.size()]) {
      trace.time.push_back(t);
      const double spike = std::abs(t - spike_at) < 1e-9 ? 1e3 : 0.0;
      signal.values.push_back(gain * std::sin(2.0 * M_PI * t) + spike);
    }
    trace.signals.push_back(std::move(signal));
    ASSERT_FALSE(trace::WriteTrace(bench_ / name, trace));
  }
  Outcome Compare(const char* a, const char* b) {
    return bench_.Call({"compare", a, b, "--tolerance", "wide.toml", "--json", "c.json"});
  }
  void SetUp() override {
    bench_.Write("wide.toml", "[signal.T]\nrelative_width = 0.01\norigin = \"integration to 1 %\"\n");
    Trace("fixed.h5", {1e-3}, 1.0);
  }
  Bench bench_;
};

TEST_F(OtherRasters, AreComparedOverTheCommonSpanWhichIsSaid) {
  Trace("adaptive.h5", {1e-4, 3e-3, 7e-4, 2.2e-3}, 1.0);
  Trace("slow.h5", {0.01}, 1.0);
  Trace("long.h5", {7e-4}, 1.5);
  for (const char* other : {"adaptive.h5", "slow.h5", "long.h5"}) {
    const Outcome outcome = Compare("fixed.h5", other);
    EXPECT_EQ(outcome.exit, 0) << other << outcome.Both();
    EXPECT_THAT(outcome.out, HasSubstr("compared from 0 to")) << other;
    const auto scenario = nlohmann::json::parse(ReadBytes(bench_ / "c.json"))["scenarios"][0];
    EXPECT_THAT(scenario["notes"][0].get<std::string>(), HasSubstr("compared from 0 to"));
    EXPECT_EQ(Compare(other, "fixed.h5").exit, 0) << other;
  }
  EXPECT_THAT(Compare("fixed.h5", "fixed.h5").out, Not(HasSubstr("compared from")));
}

TEST_F(OtherRasters, FailWithAGainOrASpikeWhereverItLies) {
  Trace("wrong.h5", {1e-4, 3e-3, 7e-4, 2.2e-3}, 1.0, 1.1);
  EXPECT_EQ(Compare("fixed.h5", "wrong.h5").exit, 1);
  EXPECT_EQ(Compare("wrong.h5", "fixed.h5").exit, 1);
  Trace("slow.h5", {0.01}, 1.0);
  Trace("spike.h5", {1e-3}, 1.0, 1.0, 0.155);
  for (const auto& [a, b] : {std::pair{"slow.h5", "spike.h5"}, {"spike.h5", "slow.h5"}}) {
    const Outcome outcome = bench_.Call({"compare", a, b});
    EXPECT_EQ(outcome.exit, 1) << outcome.Both();
    EXPECT_THAT(outcome.out, HasSubstr("apart from t = 0.155 s on"));
  }
}

TEST_F(OtherRasters, WithoutAnythingInCommonFail) {
  Trace("short.h5", {1e-3}, 0.5);
  EXPECT_THAT(Compare("fixed.h5", "short.h5").out, HasSubstr("the run is short"));
  EXPECT_EQ(Compare("fixed.h5", "short.h5").exit, 1);
}

/// A file that states no nominal: 1 % is of what the reference's values range over, and that is said.
TEST_F(OtherRasters, WithoutANominalTheReferencesRangeCounts) {
  const auto write = [&](const char* name, double size, double offset, double spike) {
    std::string text = "time [s],T [N m],zero [N m],level [bar]\n";
    for (int i = 0; i <= 1000; ++i) {
      const double t = 1e-3 * i;
      text += fmt::format("{:.3f},{:.9f},{},5\n", t, size * std::sin(6.0 * t) + offset + (i == 500 ? spike : 0.0),
                          i == 500 ? spike / size : 0.0);
    }
    bench_.Write(name, text);
  };
  bench_.Write("wide.toml",
               "[signal.T]\nrelative_width = 0.01\norigin = \"1 %\"\n"
               "[signal.zero]\nrelative_width = 0.01\norigin = \"1 %\"\n");
  write("a.csv", 1e5, 0.0, 0.0);
  write("near.csv", 1e5, 1e3, 0.0);   // 0.5 % of the range of 2e5
  write("far.csv", 1e5, 4e3, 0.0);    // 2 %
  write("spike.csv", 1e5, 0.0, 5e3);  // 2.5 % for one sample; 0.05 beside a constant 0
  const Outcome near = Compare("a.csv", "near.csv");
  EXPECT_EQ(near.exit, 0) << near.Both();
  EXPECT_THAT(near.out,
              HasSubstr("\"T\" has no nominal in the reference: 2e+05 N m is taken, how far its values range"));
  EXPECT_THAT(near.out,
              HasSubstr("\"zero\" has no nominal in the reference: 1 N m is taken, 1 of its unit, since it is 0"));
  EXPECT_THAT(near.out, HasSubstr("\"level\" has no nominal in the reference: 5 bar is taken, its constant value"));
  EXPECT_EQ(Compare("a.csv", "far.csv").exit, 1);
  const Outcome spike = Compare("a.csv", "spike.csv");
  EXPECT_EQ(spike.exit, 1);
  EXPECT_THAT(spike.out, HasSubstr("\"zero\" has no nominal in the reference"));
  // The same of an HDF5 file: 1e3 N m are nothing against a range of 2e5, and a thousand half-widths against 1.
  trace::Trace trace;
  trace::Signal signal{"T", "N m"};
  signal.nominal_known = false;
  for (int i = 0; i <= 1000; ++i) {
    trace.time.push_back(1e-3 * i);
    signal.values.push_back(1e5 * std::sin(6e-3 * i));
  }
  trace.signals.push_back(std::move(signal));
  ASSERT_FALSE(trace::WriteTrace(bench_ / "a.h5", trace));
  for (double& value : trace.signals[0].values) value += 1e3;
  ASSERT_FALSE(trace::WriteTrace(bench_ / "b.h5", trace));
  bench_.Write("wide.toml", "[signal.T]\nrelative_width = 0.01\norigin = \"1 %\"\n");
  const Outcome hdf5 = Compare("a.h5", "b.h5");
  EXPECT_EQ(hdf5.exit, 0) << hdf5.Both();
  EXPECT_THAT(hdf5.out, HasSubstr("2e+05 N m is taken"));
}

/// A step at 0.5 s as simulators write it: rows before and after it at one instant.
TEST_F(OtherRasters, RowsAtOneInstantAreAJump) {
  const auto write = [&](const char* name, double step_s, const std::vector<double>& rows) {
    std::string text = "time,T\n";
    for (int i = 0; i * step_s <= 1.0 + 1e-9; ++i) {
      const double t = i * step_s;
      if (std::abs(t - 0.5) > 1e-9) {
        text += fmt::format("{:.4f},{}\n", t, t < 0.5 ? 0 : 1);
        continue;
      }
      for (const double row : rows) text += fmt::format("{:.4f},{}\n", t, row);
    }
    bench_.Write(name, text);
  };
  write("events.csv", 1e-2, {0, 1});
  write("three.csv", 1e-2, {0, 0.5, 1});
  write("before.csv", 1e-2, {0});
  write("after.csv", 1e-2, {1});
  write("high.csv", 1e-2, {0, 9, 1});
  write("last.csv", 1e-2, {0, 9});
  write("falls.csv", 1e-2, {1, 0});
  const auto exit = [&](const char* a, const char* b) { return Compare(a, b).exit; };
  const Outcome same = Compare("events.csv", "events.csv");
  EXPECT_EQ(same.exit, 0) << same.Both();
  EXPECT_THAT(same.out, HasSubstr("events.csv: 1 instant of several rows, each taken as a jump"));
  for (const char* other : {"before.csv", "after.csv"}) {
    EXPECT_EQ(exit("events.csv", other), 0) << other;
    EXPECT_EQ(exit("three.csv", other), 0) << other;
    EXPECT_EQ(exit(other, "events.csv"), 0) << other;
  }
  for (const char* wrong : {"high.csv", "last.csv", "falls.csv"}) EXPECT_EQ(exit("events.csv", wrong), 1) << wrong;
  for (const char* wrong : {"high.csv", "last.csv"}) EXPECT_EQ(exit("after.csv", wrong), 1) << wrong;
  bench_.Write("back.csv", "time,T\n0,0\n0.2,1\n0.1,1\n");
  const Outcome back = Compare("back.csv", "back.csv");
  EXPECT_EQ(back.exit, 2);
  EXPECT_THAT(back.err, HasSubstr("the time falls at row 2"));
}

/// The same of HDF5 traces, whose stamps are the same twice: linear and held, in the middle and at both ends.
TEST_F(OtherRasters, RowsAtOneInstantOfAnHdf5TraceAreAJump) {
  const auto write = [&](const char* name, trace::Interpolation interpolation, double event,
                         const std::vector<double>& rows) {
    trace::Trace trace;
    trace::Signal signal{"T", "N m"};
    signal.interpolation = interpolation;
    std::vector<double> stamps;
    for (int i = 0; i <= 10; ++i) {
      const double t = i / 10.0;
      const std::vector<double> here = t == event ? rows : std::vector<double>{t < event ? 0.0 : 1.0};
      for (const double value : here) {
        stamps.push_back(t);
        signal.values.push_back(value);
        trace.time.push_back(static_cast<double>(trace.time.size()));
      }
    }
    trace.signals.push_back(std::move(signal));
    ASSERT_FALSE(trace::WriteTrace(bench_ / name, trace));
    Spoil(bench_ / name, [&](hid_t file) { Overwrite(file, "/time", stamps); });
  };
  const auto exit = [&](const char* a, const char* b) { return Compare(a, b).exit; };
  for (const auto interpolation : {trace::Interpolation::kLinear, trace::Interpolation::kHold}) {
    for (const double event : {0.0, 0.5, 1.0}) {
      SCOPED_TRACE(event);
      write("events.h5", interpolation, event, {0, 1});
      write("three.h5", interpolation, event, {0, 1, 1});
      write("wrong_before.h5", interpolation, event, {5, 1});
      write("wrong_after.h5", interpolation, event, {0, 5});
      const Outcome same = Compare("events.h5", "events.h5");
      EXPECT_EQ(same.exit, 0) << same.Both();
      EXPECT_THAT(same.out, HasSubstr("events.h5: 1 instant of several rows, each taken as a jump"));
      EXPECT_EQ(exit("events.h5", "three.h5"), 0);
      EXPECT_EQ(exit("three.h5", "events.h5"), 0);
      for (const char* wrong : {"wrong_before.h5", "wrong_after.h5"}) {
        EXPECT_EQ(exit("events.h5", wrong), 1) << wrong;
        EXPECT_EQ(exit(wrong, "events.h5"), 1) << wrong;
      }
    }
  }
}

TEST_F(OtherRasters, AToleranceOfNoSignalIsAFaultOfItsFile) {
  bench_.Write("wide.toml", "[signal.T_shaft]\nrelative_width = 1e-9\norigin = \"misspelt\"\n");
  const Outcome outcome = Compare("fixed.h5", "fixed.h5");
  EXPECT_EQ(outcome.exit, 2) << outcome.Both();
  EXPECT_THAT(outcome.err, HasSubstr("wide.toml:1"));
  EXPECT_THAT(outcome.err, HasSubstr("\"T_shaft\""));
  EXPECT_THAT(outcome.err, HasSubstr("did you mean \"T\"?"));
}

/// I1 - k1 - I2 - clutch - I3: the clutch is open in the linearised line.
std::string Clutch(const std::string& law) {
  return R"(title = "clutch"
source = "own numbers"
[run]
duration_s = 0.1
[plant]
type = "drive_line"
[plant.inertia]
I1 = 1.0
I2 = 0.5
I3 = 0.5
[plant.shaft.k1]
between = ["I1", "I2"]
stiffness_Nm_per_rad = 1e4
[plant.shaft.clutch]
between = ["I2", "I3"]
)" + law +
         R"(
[plant.torque.T]
on = "I1"
[input.T]
to = "plant.T"
source = { type = "constant", value = 1.0 }
[output.Tc]
of = "plant.clutch.torque"
[output.w3]
of = "plant.I3.speed"
[analysis]
input = "T"
output = "Tc"
)";
}

TEST(ModesOfAClutch, AreThoseOfTheLineWithItOpen) {
  const Bench bench;
  const double w = std::sqrt(1e4 * (1.0 / 1.0 + 1.0 / 0.5)) / (2.0 * M_PI);
  for (const char* law : {"law = \"coulomb\"\nT_c_Nm = 8.0", "law = \"dahl\"\nF_c_Nm = 8.0\nsigma_Nm_per_rad = 100.0",
                          "law = \"stribeck\"\nT_c_Nm = 6.0\nT_s_Nm = 8.0\nw_s_rad_per_s = 1.0",
                          "law = \"cubic_spring\"\nstiffness_Nm_per_rad = 0.0\nk3_Nm_per_rad3 = 1e6"}) {
    bench.Write("clutch.toml", Clutch(law));
    for (const char* output : {"Tc", "w3"}) {
      const std::string chosen = std::string("analysis.output=") + output;
      const Outcome outcome = bench.Call({"modes", "clutch.toml", "--set", chosen, "--json", "m.json"},
                                         {.environment = {{"MALLOC_PERTURB_", "85"}}});
      ASSERT_EQ(outcome.exit, 0) << law << outcome.Both();
      EXPECT_THAT(outcome.out, HasSubstr("none: the input does not reach the output"));
      EXPECT_THAT(outcome.out, Not(HasSubstr("-0.000"))) << "undamped: no sign";
      EXPECT_THAT(outcome.out, HasSubstr("shaft \"clutch\" has no linear part"));
      const auto document = nlohmann::json::parse(ReadBytes(bench / "m.json"));
      ASSERT_EQ(document["modes"].size(), 3u);
      EXPECT_EQ(document["modes"][1]["frequency_hz"], 0.0) << "both parts turn freely";
      EXPECT_NEAR(document["modes"][2]["frequency_hz"].get<double>(), w, 1e-9);  // round-off
      EXPECT_TRUE(document["zeros"].empty());
      EXPECT_EQ(document["notes"].size(), 2u);
    }
  }
}

TEST(FrictionLimit, MetExactlyHoldsWithBothSolvers) {
  const Bench bench;
  bench.Write("friction.toml", R"(title = "friction"
source = "own numbers"
[run]
duration_s = 1.0
period_s = 1e-3
[plant]
type = "drive_line"
[plant.inertia]
I1 = 0.5
[plant.load.bearing]
on = "I1"
law = "coulomb"
T_c_Nm = 10.0
[plant.torque.T]
on = "I1"
[input.T]
to = "plant.T"
source = { type = "jump", times_s = [0.1, 0.2, 0.4], values = [10.0, 12.0, 0.0] }
[output.w1]
of = "plant.I1.speed"
[[check]]
kind = "solvers"
signal = "w1"
nrmse = 1e-9
origin = "one body, piecewise constant torque"
)");
  for (const char* solver : {"realtime", "reference"}) {
    const Outcome outcome = bench.Call({"run", "friction.toml", "--solver", solver, "--out", solver});
    EXPECT_EQ(outcome.exit, 0) << outcome.Both();
    const Result<trace::Trace> trace = trace::ReadTrace(bench / solver / "friction.h5");
    ASSERT_TRUE(trace.ok());
    const std::vector<double>& w = trace->Find("w1")->values;
    EXPECT_NEAR(w[400], 0.8, 1e-10) << solver;
    EXPECT_NEAR(w.back(), 0.0, 1e-10) << solver;
  }
}

TEST(HistoryOfABenchmark, ThatErrsFailsTheCheck) {
  const Bench bench;
  const auto night = [&](int number, bool fails) {
    const std::string step = std::to_string(100.0 + 0.2 * (7 * number % 5));
    const std::string line =
        fails ? R"("cpu_time": 0.0, "error_occurred": true, "error_message": "failed")" : "\"cpu_time\": " + step;
    bench.Write("n.json", R"({"context": {}, "benchmarks": [
      {"name": "core/step", "run_name": "core/step", "run_type": "iteration", "time_unit": "ns", "cpu_time": )" +
                              step + R"(},
      {"name": "core/line", "run_name": "core/line", "run_type": "iteration", "time_unit": "ns", )" +
                              line + "}]}");
    return bench.Call({"history", "add", "n.json", "--db", "h.sqlite", "--machine", "m"});
  };
  for (int number = 1; number <= 20; ++number) {
    const Outcome added = night(number, number > 10);
    ASSERT_EQ(added.exit, 0) << added.Both();
    EXPECT_EQ(added.err.find("time/core/line") != std::string::npos, number > 10);
  }
  const Outcome check = bench.Call({"history", "check", "--db", "h.sqlite", "--json", "c.json"});
  EXPECT_EQ(check.exit, 1) << check.Both();
  EXPECT_THAT(check.out, HasSubstr("missing  time/core/line"));
  EXPECT_THAT(check.out, HasSubstr("20 nights")) << "added within seconds, and all are there";
  const auto finding = nlohmann::json::parse(ReadBytes(bench / "c.json"))["findings"][0];
  EXPECT_EQ(finding["kind"], "missing");
  EXPECT_TRUE(finding["after"].is_null());
}

}  // namespace
}  // namespace dynoproof::test
