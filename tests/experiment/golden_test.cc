// Comparing traces: what must fail, fails, and says why.
#include "experiment/golden.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <limits>

#include "experiment/thin.h"
#include "tests/support/temp_dir.h"
#include "trace/trace_io.h"

namespace dynoproof {
namespace {

using ::testing::HasSubstr;

trace::Trace Sine(std::size_t count = 20'000) {
  trace::Trace trace;
  trace::Signal signal{"T", "N m", "a torque", 100.0};
  for (std::size_t i = 0; i < count; ++i) {
    trace.time.push_back(1e-4 * static_cast<double>(i));
    signal.values.push_back(80.0 * std::sin(60.0 * trace.time.back()) + 30.0 * std::sin(411.0 * trace.time.back()));
  }
  trace.signals.push_back(std::move(signal));
  return trace;
}

score::Verdict VerdictOf(const trace::Trace& reference, const trace::Trace& test, std::string* why = nullptr) {
  const std::vector<score::Check> checks = CompareTraces(reference, test, {}, "golden", ReferenceIs::kThinned);
  if (why != nullptr) {
    for (const score::Check& check : checks) *why += check.explanation;
  }
  return score::Combine(checks);
}

TEST(CompareTraces, EqualTracesPassThinnedOrNot) {
  const trace::Trace run = Sine();
  EXPECT_EQ(VerdictOf(run, run), score::Verdict::kPass);
  const trace::Trace thin = Thin(run, 20'000);
  EXPECT_LT(thin.time.size(), 1500u);
  EXPECT_EQ(VerdictOf(thin, run), score::Verdict::kPass);
}

/// "5.4e+07 half-widths" tells a person nothing.
TEST(CompareTraces, AFailureTellsTheWorstDeviationInTheSignalsUnitAndWhen) {
  const trace::Trace run = Sine();
  trace::Trace changed = run;
  for (std::size_t i = 5000; i < 5010; ++i) changed.signals[0].values[i] += 25.0;
  changed.signals[0].values[5005] += 5.0;
  const std::vector<score::Check> checks = CompareTraces(run, changed, {}, "golden", ReferenceIs::kWhole);
  ASSERT_EQ(checks.size(), 1u);
  EXPECT_THAT(checks[0].shown, HasSubstr("30 N m off at t = 0.5005 s"));
  EXPECT_THAT(checks[0].shown, HasSubstr("N m allowed"));
}

TEST(CompareTraces, WhatIsMissingExtraShortOrNaNFails) {
  const trace::Trace run = Sine(), golden = Thin(run, 20'000);
  trace::Trace changed = run;
  changed.signals.clear();
  EXPECT_EQ(VerdictOf(golden, changed), score::Verdict::kFail) << "a deleted signal";
  changed = run;
  changed.signals.push_back({"extra", "1", "", 1.0, trace::Interpolation::kLinear, run.signals[0].values});
  EXPECT_EQ(VerdictOf(golden, changed), score::Verdict::kFail) << "an extra signal";
  changed = Sine(10'000);
  EXPECT_EQ(VerdictOf(golden, changed), score::Verdict::kFail) << "a short run";
  changed = Sine(30'000);
  EXPECT_EQ(VerdictOf(golden, changed), score::Verdict::kFail) << "a long run";
  changed = run;
  changed.signals[0].values[golden.time.size() > 3 ? 57 : 1] = std::numeric_limits<double>::quiet_NaN();
  changed.signals[0].values[0] = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(VerdictOf(golden, changed), score::Verdict::kFail) << "a NaN";
  changed = run;
  changed.signals[0].unit = "kN m";
  EXPECT_EQ(VerdictOf(golden, changed), score::Verdict::kFail) << "another unit";
  EXPECT_EQ(VerdictOf(trace::Trace{}, trace::Trace{}), score::Verdict::kFail) << "nothing compared";
}

TEST(CompareTraces, SaysWhyInOneLine) {
  const trace::Trace run = Sine();
  trace::Trace changed = run;
  for (double& value : changed.signals[0].values) value *= 1.02;
  std::string why;
  EXPECT_EQ(VerdictOf(Thin(run, 40'000), changed, &why), score::Verdict::kFail);
  EXPECT_THAT(why, HasSubstr("likely cause"));
  EXPECT_THAT(why, HasSubstr("gain"));
  EXPECT_THAT(why, HasSubstr("1.02"));
}

TEST(Golden, AMissingFileIsAFailedCheckWithTheWayOut) {
  const std::vector<score::Check> checks = CompareWithGolden(GoldenPlaceOf({"no/such_scenario", "", {}}), {}, Sine());
  ASSERT_EQ(checks.size(), 1u);
  EXPECT_EQ(checks[0].verdict, score::Verdict::kFail);
  EXPECT_THAT(checks[0].explanation, HasSubstr("dynoproof bless no/such_scenario"));
}

/// Golden files of a folder of the test's own.
class GoldenFiles : public ::testing::Test {
 protected:
  void SetUp() override {
    for (const char* name : {"scenarios", "golden"}) std::filesystem::create_directories(folder_ / name);
    setenv("DYNOPROOF_SCENARIOS", (folder_ / "scenarios").c_str(), 1);
  }
  void TearDown() override { unsetenv("DYNOPROOF_SCENARIOS"); }
  static GoldenPlace place() { return GoldenPlaceOf({"sine", "", {}}); }
  /// Sine() by this solver, off by `shift` of the nominal.
  static trace::Trace By(const char* solver, double shift) {
    trace::Trace trace = Sine();
    trace.provenance.Set("solver", solver);
    for (double& value : trace.signals[0].values) value += shift * trace.signals[0].nominal;
    return trace;
  }
  static Plan PlanWith(const std::vector<std::pair<const char*, const char*>>& checks) {
    Plan plan;
    Value::Array tables;
    for (const auto& [kind, signal] : checks) tables.push_back(Value{{"kind", kind}, {"signal", signal}});
    plan.root["check"] = Value(tables);
    return plan;
  }
  static score::Verdict VerdictOf(const trace::Trace& run, const Plan& plan = {}, std::string* why = nullptr) {
    const std::vector<score::Check> checks = CompareWithGolden(place(), plan, run);
    if (why != nullptr) {
      for (const score::Check& check : checks) *why += check.explanation;
    }
    return score::Combine(checks);
  }
  test::TempDir folder_;
};

TEST_F(GoldenFiles, KnowTheRunsLengthAndCost) {
  trace::Trace run = By("reference", 0.0);
  run.provenance.SetCounter("solver_steps", 1000);
  ASSERT_FALSE(WriteGolden(place(), {run, By("realtime", 1e-9), {}, "test"}));
  EXPECT_EQ(VerdictOf(run), score::Verdict::kPass);

  trace::Trace shorter = Sine(19'999);  // a sample that the thinned golden trace does not hold
  shorter.provenance = run.provenance;
  EXPECT_EQ(VerdictOf(shorter), score::Verdict::kFail);
  run.provenance.SetCounter("solver_steps", 1090);
  EXPECT_EQ(VerdictOf(run), score::Verdict::kPass);
  run.provenance.SetCounter("solver_steps", 1110);
  EXPECT_EQ(VerdictOf(run), score::Verdict::kFail);
  run.provenance.Set("solver", "realtime");
  EXPECT_EQ(VerdictOf(run), score::Verdict::kPass) << "other counters, nothing to say";
}

TEST_F(GoldenFiles, GiveTheOtherSolverTheRoomThatTheTwoWereApart) {
  ASSERT_FALSE(WriteGolden(place(), {By("realtime", 0.0), By("reference", 2e-6), {}, "test"}));
  const GoldenTolerances::OfSignal T = ReadTolerances((folder_ / "golden/sine.toml").string())->signals.at("T");
  EXPECT_NEAR(T.other_solver_width, 6e-6, 1.1e-7) << "rounded up to two digits";
  EXPECT_THAT(T.other_solver_origin, HasSubstr("`reference` was 2e-06 of the nominal from `realtime`"));
  EXPECT_EQ(VerdictOf(By("reference", 5e-6)), score::Verdict::kPass);
  EXPECT_EQ(VerdictOf(By("reference", 7e-6)), score::Verdict::kFail);
  EXPECT_EQ(VerdictOf(By("realtime", 5e-6)), score::Verdict::kFail) << "the same solver has no such room";
}

TEST_F(GoldenFiles, SayWhereTheOtherSolversDistanceIsNotKnown) {
  trace::Trace broken = By("reference", 0.0);
  broken.signals[0].values[7] = std::numeric_limits<double>::quiet_NaN();
  ASSERT_FALSE(WriteGolden(place(), {By("realtime", 0.0), broken, {}, "test"}));
  std::string why;
  EXPECT_EQ(VerdictOf(By("reference", 0.0), PlanWith({}), &why), score::Verdict::kFail);
  EXPECT_THAT(why, HasSubstr("how far `reference` may be from it is not known"));
  EXPECT_EQ(VerdictOf(By("realtime", 0.0)), score::Verdict::kPass);
}

TEST_F(GoldenFiles, NoticeADeletedCheck) {
  const Plan blessed = PlanWith({{"solvers", "T"}, {"solvers", "w"}, {"golden", ""}});
  const trace::Trace run = By("realtime", 0.0);
  ASSERT_FALSE(WriteGolden(place(), {run, By("reference", 0.0), StatedChecks(blessed), "test"}));
  EXPECT_EQ(VerdictOf(run, blessed), score::Verdict::kPass);
  std::string why;
  EXPECT_EQ(VerdictOf(run, PlanWith({{"solvers", "T"}, {"golden", ""}}), &why), score::Verdict::kFail);
  EXPECT_THAT(why, HasSubstr("no longer stated: solvers w"));
  EXPECT_EQ(VerdictOf(run, PlanWith({{"solvers", "T"}, {"solvers", "w"}, {"golden", ""}, {"bounded", "T"}})),
            score::Verdict::kPass)
      << "one more is no fault";
  // And the golden check itself.
  EXPECT_FALSE(GoldenNotStated(place(), blessed));
  const std::optional<score::Check> gone = GoldenNotStated(place(), PlanWith({{"solvers", "T"}}));
  ASSERT_TRUE(gone);
  EXPECT_EQ(gone->verdict, score::Verdict::kFail);
  EXPECT_FALSE(GoldenNotStated(GoldenPlaceOf({"never_blessed", "", {}}), PlanWith({{"solvers", "T"}})));
}

TEST_F(GoldenFiles, BelongTogether) {
  ASSERT_FALSE(WriteGolden(place(), {By("realtime", 0.0), By("reference", 0.0), {}, "test"}));
  ASSERT_FALSE(trace::WriteTrace(folder_ / "golden/sine.h5", By("realtime", 1e-3)));
  std::string why;
  EXPECT_EQ(VerdictOf(By("realtime", 1e-3), PlanWith({}), &why), score::Verdict::kFail);
  EXPECT_THAT(why, HasSubstr("SHA-256 differs"));
}

/// `reduce` compares with the blessed scenario. If an unreadable file counted as a missing one, `reduce` would work without it.
TEST_F(GoldenFiles, AScenarioThatCannotBeReadIsNotTakenForNone) {
  const Result<std::optional<Value>> missing = BlessedScenario(place());
  ASSERT_TRUE(missing.ok()) << missing.failure().ToString();
  EXPECT_FALSE(missing->has_value());
  trace::Trace run = By("realtime", 0.0);
  run.scenario = "title = \"sine\"\n";
  ASSERT_FALSE(trace::WriteTrace(folder_ / "golden/sine.h5", run));
  const Result<std::optional<Value>> blessed = BlessedScenario(place());
  ASSERT_TRUE(blessed.ok() && blessed->has_value());
  EXPECT_EQ((*blessed)->TextOr("title", ""), "sine");
  folder_.Write("golden/sine.h5", "no trace");
  EXPECT_FALSE(BlessedScenario(place()).ok());
}

TEST_F(GoldenFiles, AFaultyToleranceFileIsNotOverwritten) {
  const std::string file =
      folder_.Write("golden/sine.toml", "[signal.T]\nrelative_width = 1e-3\norigin = \"mine\"\nwidht = 1\n");
  EXPECT_TRUE(WriteGolden(place(), {Sine(), Sine(), {}, "test"}));
  EXPECT_FALSE(std::filesystem::exists(folder_ / "golden/sine.h5"));
}

}  // namespace
}  // namespace dynoproof
