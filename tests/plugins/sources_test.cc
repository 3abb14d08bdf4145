// Sources: values by hand, edges, faults.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "plugins/source/replay/replay.h"
#include "tests/support/build.h"

namespace dynoproof {
namespace {

using testing::Build;
using ::testing::HasSubstr;
using testing::OutputOf;

constexpr double kTwoPi = 2.0 * std::numbers::pi;

double At(const Value& table, double time_s) {
  std::string faults;
  const auto source = Build("source", table, {}, &faults);
  if (source == nullptr) ADD_FAILURE() << faults;
  return source == nullptr ? std::nan("") : OutputOf(*source, time_s);
}

std::string FaultsOf(const Value& table) {
  std::string faults;
  EXPECT_EQ(Build("source", table, {}, &faults), nullptr);
  return faults;
}

TEST(Chirp, FollowsTheThesis) {
  const Value chirp = {{"type", "chirp"}, {"end_Hz", 2000.0}, {"rate_Hz_per_s", 200.0}, {"amplitude", 3.0}};
  for (const double t : {0.0, 0.0123, 1.7, 9.9999}) {
    // (2.7): the phase is 2 pi times the integral of kappa tau. Its argument reaches 1e4 cycles, whose rounding is
    // 1e4 * 2 pi * 1e-16 = 7e-12.
    EXPECT_NEAR(At(chirp, t), 3.0 * std::sin(kTwoPi * 200.0 * t * t / 2.0), 3e-11) << t;
  }
  EXPECT_EQ(At(chirp, 10.1), 0.0);
  EXPECT_EQ(At(chirp, -0.1), 0.0);
}

TEST(Chirp, GoesOnInPhase) {
  Value chirp = {{"type", "chirp"},  {"start_Hz", 5.0}, {"end_Hz", 1.0},   {"duration_s", 1.5},
                 {"amplitude", 2.0}, {"offset", 10.0},  {"after", "keep"}, {"start_time_s", 1.0}};
  // Falling from 5 to 1 Hz in 1.5 s: 4.5 cycles, then 1 Hz.
  EXPECT_NEAR(At(chirp, 2.5), 10.0, 1e-12);  // some ulps of 10
  EXPECT_NEAR(At(chirp, 2.75), 8.0, 1e-12);
  EXPECT_EQ(At(chirp, 0.5), 10.0);
}

TEST(Chirp, NeedsRateOrDuration) {
  Value chirp = {{"type", "chirp"}, {"end_Hz", 100.0}, {"amplitude", 1.0}};
  EXPECT_THAT(FaultsOf(chirp), HasSubstr("give either rate_Hz_per_s or duration_s"));
  chirp["rate_Hz_per_s"] = Value(10.0);
  chirp["duration_s"] = Value(10.0);
  EXPECT_THAT(FaultsOf(chirp), HasSubstr("give either rate_Hz_per_s or duration_s"));
}

TEST(Levels, ChangeAtTheirTickDespiteRounding) {
  const Value step = {{"type", "step"}, {"initial", -1.0}, {"value", 1.0}, {"time_s", 0.3}};
  EXPECT_EQ(At(step, std::nextafter(0.3, 0.0)), 1.0);
  EXPECT_EQ(At(step, 0.3 - 1e-6), -1.0);
  const Value jump = {
      {"type", "jump"}, {"initial", -1.0}, {"times_s", Value::Array{0.1, 0.3}}, {"values", Value::Array{2.0, 3.0}}};
  EXPECT_EQ(At(jump, 0.0999), -1.0);
  EXPECT_EQ(At(jump, 0.1), 2.0);
  EXPECT_EQ(At(jump, std::nextafter(0.3, 0.0)), 3.0);
  EXPECT_EQ(At(jump, 100.0), 3.0);
}

TEST(Levels, RampIsStraightBetweenItsEnds) {
  const Value ramp = {{"type", "ramp"}, {"from", 2.0}, {"to", -2.0}, {"start_time_s", 1.0}, {"duration_s", 4.0}};
  EXPECT_EQ(At(ramp, 0.5), 2.0);
  EXPECT_EQ(At(ramp, 2.0), 1.0);
  EXPECT_EQ(At(ramp, 9.0), -2.0);
}

TEST(Levels, JumpFaults) {
  EXPECT_THAT(FaultsOf({{"type", "jump"}, {"times_s", Value::Array{0.1, 0.1}}, {"values", Value::Array{1.0, 2.0}}}),
              HasSubstr("the times do not rise"));
  EXPECT_THAT(FaultsOf({{"type", "jump"}, {"times_s", Value::Array{0.1}}, {"values", Value::Array{1.0, 2.0}}}),
              HasSubstr("1 times and 2 values"));
}

TEST(Tones, SineSumIsTheLoadOfTheThesis) {
  const Value load = {{"type", "sine_sum"},
                      {"offset", 65.0},
                      {"amplitudes", Value::Array{-400.0, 300.0}},
                      {"frequencies_Hz", Value::Array{225.0, 450.0}},
                      {"start_time_s", 2.0}};
  EXPECT_EQ(At(load, 1.9), 0.0);
  const double t = 3.0 + 1.0 / 900.0;  // a quarter period of 225 Hz
  // 225 Hz * 1 s cycles of rounding: 1e-13 of 400.
  EXPECT_NEAR(At(load, t), 65.0 - 400.0, 1e-9);
}

TEST(Tones, MultisineHasItsRmsAndItsSeed) {
  Value tones = {{"type", "multisine"}, {"low_Hz", 10.0}, {"high_Hz", 100.0}, {"lines", 10}, {"rms", 3.0}, {"seed", 4}};
  const auto source = Build("source", tones);
  ASSERT_NE(source, nullptr);
  double square = 0.0;
  for (int i = 0; i < 1000; ++i) square += std::pow(OutputOf(*source, i * 1e-4), 2) / 1000.0;  // one period of 10 Hz
  EXPECT_NEAR(std::sqrt(square), 3.0, 1e-12);  // orthogonal on the samples: round-off of 1000 terms
  const double value = At(tones, 0.0371);
  EXPECT_EQ(OutputOf(*Build("source", tones, {.seed = 99}), 0.0371), value);  // its own seed wins
  tones["seed"] = Value(5);
  EXPECT_NE(At(tones, 0.0371), value);
}

TEST(Noise, IsHeldWhiteAndGaussian) {
  const Value noise = {{"type", "noise"}, {"std", 2.0}, {"offset", 1.0}, {"sample_period_s", 0.01}};
  const auto source = Build("source", noise);
  ASSERT_NE(source, nullptr);
  EXPECT_EQ(OutputOf(*source, 0.0700), OutputOf(*source, 0.0799));
  EXPECT_EQ(OutputOf(*source, 7 * 0.01), OutputOf(*source, 0.0750));  // 7 * 0.01 lies one ulp above 0.07
  EXPECT_NE(OutputOf(*source, 0.0800), OutputOf(*source, 0.0799));
  constexpr int kSamples = 20000;
  double mean = 0.0, square = 0.0, lag = 0.0, last = 0.0;
  for (int i = 0; i < kSamples; ++i) {
    const double x = OutputOf(*source, i * 0.01) - 1.0;
    mean += x / kSamples;
    square += x * x / kSamples;
    lag += x * last / kSamples;
    last = x;
  }
  // Four standard errors of each estimate: std/sqrt(n), std^2 sqrt(2/n), std^2/sqrt(n).
  EXPECT_NEAR(mean, 0.0, 4 * 2.0 / std::sqrt(kSamples));
  EXPECT_NEAR(square, 4.0, 4 * 4.0 * std::sqrt(2.0 / kSamples));
  EXPECT_NEAR(lag, 0.0, 4 * 4.0 / std::sqrt(kSamples));
}

TEST(Noise, SeedOfTheBlockCounts) {
  const Value noise = {{"type", "noise"}, {"std", 1.0}};
  EXPECT_NE(OutputOf(*Build("source", noise, {.seed = 1}), 0.5), OutputOf(*Build("source", noise, {.seed = 2}), 0.5));
}

TEST(Sum, AddsAndGivesEachSummandItsOwnSeed) {
  const Value noise = {{"type", "noise"}, {"std", 1.0}}, level = {{"type", "constant"}, {"value", 5.0}};
  EXPECT_EQ(At({{"type", "sum"}, {"sources", Value::Array{level, level}}}, 1.0), 10.0);
  const double one = At({{"type", "sum"}, {"sources", Value::Array{noise}}}, 1.0);
  const double two = At({{"type", "sum"}, {"sources", Value::Array{noise, noise}}}, 1.0);
  EXPECT_NE(two, 2.0 * one);
}

TEST(Sum, ReportsTheFaultsOfItsSummands) {
  const Value bad = {{"type", "chrip"}}, level = {{"type", "constant"}, {"valu", 5.0}};
  const std::string faults = FaultsOf({{"type", "sum"}, {"sources", Value::Array{bad, level}}});
  EXPECT_THAT(faults, HasSubstr("did you mean \"chirp\"?"));
  EXPECT_THAT(faults, HasSubstr("did you mean \"value\"?"));
  EXPECT_THAT(FaultsOf({{"type", "sum"}, {"sources", Value::Array{}}}), HasSubstr("nothing to sum"));
}

TEST(Replay, HoldsOrInterpolates) {
  Value record = {
      {"type", "replay"}, {"times_s", Value::Array{0.1, 0.2, 0.4}}, {"values", Value::Array{1.0, 3.0, -1.0}}};
  EXPECT_EQ(At(record, 0.0), 1.0);
  EXPECT_EQ(At(record, 0.15), 1.0);
  EXPECT_EQ(At(record, std::nextafter(0.2, 0.0)), 3.0);
  EXPECT_EQ(At(record, 9.0), -1.0);
  record["interpolation"] = Value("linear");
  EXPECT_DOUBLE_EQ(At(record, 0.15), 2.0);
  EXPECT_DOUBLE_EQ(At(record, 0.3), 1.0);
  EXPECT_EQ(At(record, 0.0), 1.0);
  EXPECT_EQ(At(record, 9.0), -1.0);
}

/// A replay of `count` samples of f(t) at 1 Hz.
template <class F>
Value Sampled(int count, const F& f) {
  Value::Array times, values;
  for (int i = 0; i < count; ++i) {
    times.emplace_back(static_cast<double>(i));
    values.emplace_back(f(static_cast<double>(i)));
  }
  return {{"type", "replay"}, {"times_s", times}, {"values", values}, {"interpolation", "band_limited"}};
}

TEST(Replay, BandLimitedIsTheSignalBetweenItsSamples) {
  for (const double frequency : {0.01, 0.1, 0.25, 0.4}) {  // 0.4 Hz: 0.8 of half the rate
    const auto tone = [&](double t) { return std::cos(kTwoPi * frequency * t + 0.3); };
    const Value record = Sampled(128, tone);
    for (double t = 40.0; t < 88.0; t += 0.173) {  // 32 samples from either end
      // Blackman's window lets 2e-4 of the image through at most (-74 dB); seen: 5e-5.
      ASSERT_NEAR(At(record, t), tone(t), 1e-4) << frequency << " Hz at " << t;
    }
    EXPECT_EQ(At(record, 60.0), tone(60.0)) << "a sample is itself";
  }
}

TEST(Replay, BandLimitedEndsAsItsEndSamples) {
  const Value constant = Sampled(5, [](double) { return 2.5; });
  for (const double t : {-3.0, 0.1, 2.5, 3.999, 4.0, 7.0}) EXPECT_DOUBLE_EQ(At(constant, t), 2.5) << t;
  const Value ramp = Sampled(128, [](double t) { return t; });
  EXPECT_EQ(At(ramp, -1.0), 0.0);
  EXPECT_EQ(At(ramp, 200.0), 127.0);
  EXPECT_NEAR(At(ramp, 64.3), 64.3, 1e-3);
  // Before the first sample 0 goes on: the corner rings by some hundredths of what it turns in a step.
  EXPECT_NEAR(At(ramp, 0.5), 0.5, 0.15);
  EXPECT_NE(At(ramp, 0.5), 0.5);
}

TEST(Replay, BandLimitedNeedsEqualSteps) {
  Value record = Sampled(4, [](double t) { return t; });
  record["times_s"] = Value::Array{0.0, 1.0, 2.0, 3.5};
  EXPECT_THAT(FaultsOf(record), HasSubstr("equal steps"));
  record["times_s"] = Value::Array{0.0, 1.005, 2.0, 3.0};
  EXPECT_TRUE(std::isfinite(At(record, 0.5)));
  const Value one = Sampled(1, [](double t) { return t; });
  EXPECT_THAT(FaultsOf(one), HasSubstr("one sample"));
}

TEST(Replay, SaysWhatIsWrongWithARecord) {
  const auto problem = [](std::vector<double> times, std::vector<double> values) {
    return sources::ProblemOf({std::make_shared<const std::vector<double>>(std::move(times)),
                               std::make_shared<const std::vector<double>>(std::move(values))})
        .value_or("");
  };
  EXPECT_THAT(problem({0.0, 1.0, 1.0}, {1.0, 2.0, 3.0}), HasSubstr("do not rise after 1 s (sample 1)"));
  EXPECT_EQ(problem({0.0, 1.0, 2.0}, {1.0, 2.0, 3.0}), "");
  EXPECT_EQ(problem({0.0, 1.0, 2.0}, {1.0, std::nan(""), 3.0}), "a value is not finite");
  EXPECT_EQ(problem({0.0, 1.0, 2.0}, {1.0, 2.0}), "3 times and 2 values");
}

}  // namespace
}  // namespace dynoproof
