// Comparing traces: what must fail, fails, and says why.
#include "experiment/golden.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <limits>

#include "tests/support/temp_dir.h"

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
  const std::vector<score::Check> checks = CompareTraces(reference, test, {}, "golden");
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
  const std::vector<score::Check> checks = CompareWithGolden(GoldenPlaceOf({"no/such_scenario", "", {}}), Sine());
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
  test::TempDir folder_;
};

TEST_F(GoldenFiles, KnowTheRunsLengthAndCost) {
  trace::Trace run = Sine();
  run.provenance.Set("solver", "reference");
  run.provenance.SetCounter("solver_steps", 1000);
  ASSERT_FALSE(WriteGolden(place(), run, "test"));
  EXPECT_EQ(score::Combine(CompareWithGolden(place(), run)), score::Verdict::kPass);

  trace::Trace shorter = Sine(19'999);  // a sample that the thinned golden trace does not hold
  shorter.provenance = run.provenance;
  EXPECT_EQ(score::Combine(CompareWithGolden(place(), shorter)), score::Verdict::kFail);
  run.provenance.SetCounter("solver_steps", 1090);
  EXPECT_EQ(score::Combine(CompareWithGolden(place(), run)), score::Verdict::kPass);
  run.provenance.SetCounter("solver_steps", 1110);
  EXPECT_EQ(score::Combine(CompareWithGolden(place(), run)), score::Verdict::kFail);
  run.provenance.Set("solver", "realtime");
  EXPECT_EQ(score::Combine(CompareWithGolden(place(), run)), score::Verdict::kPass) << "other counters, nothing to say";
}

TEST_F(GoldenFiles, AFaultyToleranceFileIsNotOverwritten) {
  const std::string file =
      folder_.Write("golden/sine.toml", "[signal.T]\nrelative_width = 1e-3\norigin = \"mine\"\nwidht = 1\n");
  EXPECT_TRUE(WriteGolden(place(), Sine(), "test"));
  EXPECT_FALSE(std::filesystem::exists(folder_ / "golden/sine.h5"));
}

}  // namespace
}  // namespace dynoproof
