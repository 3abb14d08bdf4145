// What a comparison sees beside the reference's own samples: between them, on other rasters, beyond the common span.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <random>

#include "base/text.h"
#include "experiment/golden.h"
#include "experiment/thin.h"
#include "tests/support/temp_dir.h"
#include "trace/trace_io.h"

namespace dynoproof {
namespace {

using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::SizeIs;

double Course(double t) { return 80.0 * std::sin(20.0 * t); }

/// One signal T at these instants.
trace::Trace At(const std::vector<double>& times, double (*course)(double) = Course) {
  trace::Trace trace;
  trace.time = times;
  trace::Signal signal{"T", "N m", "a torque", 100.0};
  for (const double t : times) signal.values.push_back(course(t));
  trace.signals.push_back(std::move(signal));
  return trace;
}

std::vector<double> Every(double step_s, double from_s, double to_s) {
  std::vector<double> times;
  for (int i = 0; from_s + i * step_s <= to_s + 1e-9; ++i) times.push_back(from_s + i * step_s);
  return times;
}

struct Outcome {
  score::Verdict verdict;
  std::string why;
  std::vector<std::string> notes;
};
Outcome Compare(const trace::Trace& reference, const trace::Trace& test, ReferenceIs is = ReferenceIs::kWhole) {
  Outcome outcome{};
  const std::vector<score::Check> checks = CompareTraces(reference, test, {}, "tube", is, &outcome.notes);
  for (const score::Check& check : checks) outcome.why += check.explanation;
  outcome.verdict = score::Combine(checks);
  return outcome;
}

constexpr score::Verdict kPass = score::Verdict::kPass, kFail = score::Verdict::kFail;

TEST(CompareTraces, SeesASpikeBetweenTheSamplesOfEither) {
  const trace::Trace coarse = At(Every(0.01, 0.0, 1.0));
  trace::Trace fine = At(Every(0.001, 0.0, 1.0));
  EXPECT_EQ(Compare(coarse, fine).verdict, kPass);
  EXPECT_EQ(Compare(fine, coarse).verdict, kPass);
  fine.signals[0].values[155] += 1e5;
  EXPECT_EQ(Compare(coarse, fine).verdict, kFail);
  EXPECT_THAT(Compare(coarse, fine).why, HasSubstr("apart from t = 0.155 s on"));
  EXPECT_EQ(Compare(fine, coarse).verdict, kFail);
}

TEST(CompareTraces, ComparesOtherRastersOverTheirCommonSpanAndSaysSo) {
  const trace::Trace reference = At(Every(0.001, 0.0, 1.0));
  EXPECT_THAT(Compare(reference, reference).notes, IsEmpty());
  const std::vector<double> longer = Every(0.0007, 0.0, 1.2), later = Every(0.0013, 0.1, 1.0);
  const std::vector<double> shorter = Every(0.0007, 0.0, 0.8);
  for (const auto& [times, span] :
       {std::pair{longer, "from 0 to 1 s"}, {later, "from 0.1 to 0.9996 s"}, {shorter, "from 0 to 0.7994 s"}}) {
    for (const bool turned : {false, true}) {
      const trace::Trace other = At(times);
      const Outcome outcome = turned ? Compare(other, reference) : Compare(reference, other);
      EXPECT_EQ(outcome.verdict, kPass) << span << ": " << outcome.why;
      ASSERT_THAT(outcome.notes, SizeIs(1));
      EXPECT_THAT(outcome.notes[0], HasSubstr("compared " + std::string(span)));
      EXPECT_THAT(outcome.why, HasSubstr("compared " + std::string(span)));
    }
    EXPECT_EQ(Compare(reference, At(times, [](double t) { return 1.001 * Course(t); })).verdict, kFail) << span;
  }
}

TEST(CompareTraces, WhatWasCutOffOrIsFarFromCommonFails) {
  const trace::Trace reference = At(Every(0.001, 0.0, 1.0));
  const auto expect_fault = [&](const std::vector<double>& times, const char* text) {
    const Outcome outcome = Compare(reference, At(times));
    EXPECT_EQ(outcome.verdict, kFail) << text;
    EXPECT_THAT(outcome.why, HasSubstr(text));
  };
  // On the reference's own raster, a part of it or more than it.
  expect_fault(Every(0.001, 0.0, 0.6), "the run is short: it goes from 0 to 0.6 s");
  expect_fault(Every(0.001, 0.0, 0.6), "what both have is within the tube");
  expect_fault(Every(0.001, 0.2, 1.0), "the run is short");
  expect_fault(Every(0.001, 0.0, 1.3), "the run goes on");
  // On another one, less than half of it, or nothing.
  expect_fault(Every(0.0007, 0.0, 0.4), "the run is short");
  expect_fault(Every(0.0007, 1.5, 2.0), "nothing in common in time");
  expect_fault(Every(0.001, 1.0, 2.0), "nothing in common in time");
  // A last sample that one program counts and another does not.
  for (const double end : {0.999, 1.001}) EXPECT_EQ(Compare(reference, At(Every(0.001, 0.0, end))).verdict, kPass);
}

TEST(CompareTraces, StampsThatDifferByRoundOffAreTheSame) {
  const trace::Trace reference = At(Every(0.001, 0.0, 1.0));
  trace::Trace summed = reference;
  for (std::size_t i = 1; i < summed.time.size(); ++i) summed.time[i] = summed.time[i - 1] + 0.001;
  const Outcome outcome = Compare(reference, summed);
  EXPECT_EQ(outcome.verdict, kPass) << outcome.why;
  EXPECT_THAT(outcome.notes, IsEmpty());
}

TEST(CompareTraces, UnitsAreComparedByTheirMeaning) {
  const trace::Trace reference = At(Every(0.001, 0.0, 1.0));
  trace::Trace test = reference;
  for (const char* same : {"Nm", "N*m", "N m"}) {
    test.signals[0].unit = same;
    EXPECT_EQ(Compare(reference, test).verdict, kPass) << same;
  }
  for (const char* other : {"kN m", "N", "", "N m/rad", "furlongs"}) {
    test.signals[0].unit = other;
    EXPECT_EQ(Compare(reference, test).verdict, kFail) << other;
  }
}

TEST(CompareTraces, AToleranceThatBelongsToNoSignalIsAFault) {
  const trace::Trace trace = At(Every(0.01, 0.0, 1.0));
  Diagnostics diagnostics;
  CheckTolerances({{"T", {}}}, trace, trace, diagnostics);
  EXPECT_FALSE(diagnostics.has_errors());
  CheckTolerances({{"t", {}}, {"T_shaft", {}}}, trace, trace, diagnostics);
  EXPECT_EQ(diagnostics.error_count(), 2);
  EXPECT_THAT(diagnostics.Format(), HasSubstr("\"T_shaft\""));
  EXPECT_THAT(diagnostics.Format(), HasSubstr("did you mean \"T\"?"));
}

/// What Thin() kept of `run`, without what it tells of the samples between.
trace::Trace SamplesAlone(const trace::Trace& thin) {
  trace::Trace alone = thin;
  std::erase_if(alone.signals, [&](const trace::Signal& signal) { return IsOfStretches(thin, signal); });
  return alone;
}

TEST(ThinnedReference, HoldsEverySampleBetweenItsOwn) {
  const trace::Trace run = At(Every(1e-4, 0.0, 2.0)), thin = Thin(run, 20'000);
  ASSERT_LT(thin.time.size(), run.time.size() / 10);
  ASSERT_LT(thin.time.back(), run.time.back());  // what comes behind is in the last stretch
  EXPECT_EQ(Compare(thin, run, ReferenceIs::kThinned).verdict, kPass);
  // A lone sample moves the mean of its stretch by a share of itself, however far it stays within the signal's range.
  const double half_width = 1e-7 * run.signals[0].nominal;
  const double longest = 10.0 * static_cast<double>(run.time.size()) / static_cast<double>(thin.time.size());
  for (const double spike : {longest * half_width, -longest * half_width, 1.0, 400.0, 1e5}) {
    for (const std::size_t at : {std::size_t{1}, std::size_t{10'001}, run.time.size() - 2, run.time.size() - 1}) {
      trace::Trace spoilt = run;
      spoilt.signals[0].values[at] += spike;
      EXPECT_EQ(Compare(thin, spoilt, ReferenceIs::kThinned).verdict, kFail) << spike << " at " << at;
    }
  }
  trace::Trace spoilt = run;
  spoilt.signals[0].values[10'001] += 400.0;
  EXPECT_THAT(Compare(thin, spoilt, ReferenceIs::kThinned).why,
              HasSubstr("the greatest value, at t = 1.0001 s, is 473.101 N m, and "));
  // Two that cancel in the mean move the extremes.
  spoilt.signals[0].values[10'002] -= 400.0;
  EXPECT_EQ(Compare(thin, spoilt, ReferenceIs::kThinned).verdict, kFail);
  // On another raster a run is no run of that scenario.
  EXPECT_EQ(Compare(thin, At(Every(1.1e-4, 0.0, 2.0)), ReferenceIs::kThinned).verdict, kFail);
}

TEST(ThinnedReference, WithRoomInTimeHoldsExtremesToTheStretchesAround) {
  const trace::Trace run = At(Every(1e-4, 0.0, 2.0)), thin = Thin(run, 20'000);
  const trace::Trace late = At(run.time, [](double t) { return Course(std::max(t - 0.004, 0.0)); });
  SignalTolerance tolerance;
  tolerance.relative_width = 1e-3;  // more than what lies between the chords of the kept samples and the course
  EXPECT_EQ(score::Combine(CompareTraces(thin, late, {{"T", tolerance}}, "tube", ReferenceIs::kThinned)), kFail);
  tolerance.time_half_width_s = 0.005;
  EXPECT_EQ(score::Combine(CompareTraces(thin, late, {{"T", tolerance}}, "tube", ReferenceIs::kThinned)), kPass);
  trace::Trace spoilt = late;
  spoilt.signals[0].values[10'001] -= 100.0;
  EXPECT_EQ(score::Combine(CompareTraces(thin, spoilt, {{"T", tolerance}}, "tube", ReferenceIs::kThinned)), kFail);
}

/// Noise and lone pulses are part of a run: it passes as it was blessed, and fails with one pulse more.
TEST(ThinnedReference, OfAnotherLengthFailsAndTellsOfWhatBothHave) {
  const trace::Trace thin = Thin(At(Every(1e-4, 0.0, 2.0)), 20'000);
  for (const double end : {1.2345, 2.6}) {
    const Outcome same = Compare(thin, At(Every(1e-4, 0.0, end)), ReferenceIs::kThinned);
    EXPECT_EQ(same.verdict, kFail);
    EXPECT_THAT(same.why, HasSubstr(end < 2.0 ? "the run is short: it ends at 1.2345 s" : "the run goes on"));
    EXPECT_THAT(same.why, HasSubstr("what both have is within the tube"));
    trace::Trace other = At(Every(1e-4, 0.0, end));
    for (std::size_t i = 5000; i < other.time.size(); ++i) other.signals[0].values[i] *= 1.01;
    const Outcome off = Compare(thin, other, ReferenceIs::kThinned);
    EXPECT_EQ(off.verdict, kFail);
    EXPECT_THAT(off.why, HasSubstr("apart from t = 0.5"));
  }
  EXPECT_EQ(Compare(thin, At({0.0, 1e-5}), ReferenceIs::kThinned).verdict, kFail);
}

TEST(ThinnedReference, KnowsNoiseAndPulsesOfTheBlessedRun) {
  const test::TempDir folder;
  const GoldenPlace place{(folder / "noise.h5").string(), (folder / "noise.toml").string(), "dynoproof bless"};
  trace::Trace run = At(Every(1e-4, 0.0, 2.0), [](double) { return 0.0; });
  std::mt19937_64 random(3);
  std::normal_distribution<double> normal;
  for (double& value : run.signals[0].values) value = normal(random);
  run.signals[0].values[10'001] += 50.0;
  run.provenance.Set("solver", "realtime");
  ASSERT_FALSE(WriteGolden(place, {run, run, {}, "test"}));
  EXPECT_EQ(score::Combine(CompareWithGolden(place, {}, run)), kPass);
  run.signals[0].values[10'002] += 0.1;
  EXPECT_EQ(score::Combine(CompareWithGolden(place, {}, run)), kFail);
}

/// Golden traces of earlier versions keep samples and nothing else: what lies between would pass unseen.
TEST(ThinnedReference, ThatTellsNothingOfWhatLiesBetweenIsToBeBlessedAnew) {
  const trace::Trace run = At(Every(1e-4, 0.0, 2.0));
  const Outcome outcome = Compare(SamplesAlone(Thin(run, 20'000)), run, ReferenceIs::kThinned);
  EXPECT_EQ(outcome.verdict, kFail);
  EXPECT_THAT(outcome.why, HasSubstr("bless the scenario anew"));
}

}  // namespace
}  // namespace dynoproof
