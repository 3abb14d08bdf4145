// Actuator and sensor stages: values by hand, edges, faults.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <vector>

#include "tests/support/build.h"

namespace dynoproof {
namespace {

using testing::Build;
using testing::OutputOf;

double Map(const std::string& kind, const Value& table, double in, double time_s = 0.0) {
  const auto stage = Build(kind, table, {.nominal = 1000.0});
  if (stage == nullptr) ADD_FAILURE() << "not built";
  return stage == nullptr ? std::nan("") : OutputOf(*stage, time_s, {&in, 1});
}

TEST(Saturation, LimitsTheMagnitude) {
  const Value table = {{"type", "saturation"}, {"limit", 2.0}};
  EXPECT_EQ(Map("actuator", table, 1.5), 1.5);
  EXPECT_EQ(Map("actuator", table, 2.5), 2.0);
  EXPECT_EQ(Map("actuator", table, -2.5), -2.0);
}

TEST(DeadZone, WidthIsTotalAndTheOutsideIsShifted) {
  const Value table = {{"type", "dead_zone"}, {"width", 2.0}};
  EXPECT_EQ(Map("actuator", table, 0.9), 0.0);
  EXPECT_EQ(Map("actuator", table, -1.0), 0.0);
  EXPECT_EQ(Map("actuator", table, 1.5), 0.5);
  EXPECT_EQ(Map("actuator", table, -3.0), -2.0);
}

TEST(Kinks, AreWhereTheGuardsChangeSign) {
  for (const auto& [table, kink] : {std::pair(Value{{"type", "saturation"}, {"limit", 2.0}}, 2.0),
                                    std::pair(Value{{"type", "dead_zone"}, {"width", 3.0}}, 1.5)}) {
    const auto stage = Build("actuator", table);
    ASSERT_NE(stage, nullptr);
    for (const int side : {0, 1}) {
      const double inner = (side == 0 ? 1.0 : -1.0) * (kink - 1e-9), outer = (side == 0 ? 1.0 : -1.0) * (kink + 1e-9);
      std::vector<double> in(2), out(2);
      stage->Guards({0.0, {&inner, 1}, {}, {}}, in);
      stage->Guards({0.0, {&outer, 1}, {}, {}}, out);
      EXPECT_GT(in[side], 0.0);
      EXPECT_LT(out[side], 0.0);
      EXPECT_EQ(in[1 - side] > 0.0, out[1 - side] > 0.0);
    }
  }
}

TEST(Harmonic, GivesASineItsHarmonics) {
  const Value table = {{"type", "harmonic"}, {"h2", 0.1}, {"h3", 0.04}};
  const auto stage = Build("actuator", table, {.nominal = 1000.0});
  ASSERT_NE(stage, nullptr);
  constexpr int kSamples = 64;
  double second = 0.0, third = 0.0;  // Fourier coefficients of cos 2x and sin 3x
  for (int i = 0; i < kSamples; ++i) {
    const double x = 2.0 * std::numbers::pi * i / kSamples, in = 1000.0 * std::sin(x);
    const double out = OutputOf(*stage, 0.0, {&in, 1});
    second += 2.0 / kSamples * out * std::cos(2 * x);
    third += 2.0 / kSamples * out * std::sin(3 * x);
  }
  // sin^2 = (1 - cos 2x)/2, sin^3 = (3 sin x - sin 3x)/4; round-off of 64 terms of 1000.
  EXPECT_NEAR(second, -0.5 * 0.1 * 1000.0, 1e-9);
  EXPECT_NEAR(third, -0.25 * 0.04 * 1000.0, 1e-9);
}

TEST(Harmonic, OwnNominalWinsOverTheInputs) {
  EXPECT_DOUBLE_EQ(Map("actuator", {{"type", "harmonic"}, {"h2", 0.1}}, 500.0), 500.0 + 0.1 * 250.0);
  EXPECT_DOUBLE_EQ(Map("actuator", {{"type", "harmonic"}, {"h2", 0.1}, {"nominal", 100.0}}, 500.0),
                   500.0 + 0.1 * 2500.0);
}

TEST(FirstOrderLag, DerivativeIsTheSlopeOfTheExactStepResponse) {
  const double tau = 0.02, in = 5.0, start = -1.0;
  for (const char* kind : {"actuator", "sensor"}) {
    const auto lag = Build(kind, {{"type", "first_order_lag"}, {"tau_s", tau}});
    ASSERT_NE(lag, nullptr);
    const auto exact = [&](double t) { return in + (start - in) * std::exp(-t / tau); };
    for (const double t : {0.0, 0.01, 0.05}) {
      const double state = exact(t), h = 1e-5;
      double rate = 0.0;
      lag->Derivative({t, {&in, 1}, {&state, 1}, {}}, {&rate, 1});
      // Central difference: (h/tau)^2 / 6 of the rate, and round-off 1e-15 * 5 / h.
      EXPECT_NEAR(rate, (exact(t + h) - exact(t - h)) / (2 * h), 1e-7 * std::abs(rate) + 1e-9);
      EXPECT_EQ(OutputOf(*lag, t, {&in, 1}, {&state, 1}), state);
    }
  }
}

TEST(FirstOrderLag, OfNoTimeIsAWire) {
  const auto lag = Build("sensor", {{"type", "first_order_lag"}, {"tau_s", 0.0}});
  ASSERT_NE(lag, nullptr);
  EXPECT_TRUE(lag->layout().states.empty());
  EXPECT_TRUE(lag->FeedsThrough(0, 0));
  const double in = 3.0;
  EXPECT_EQ(OutputOf(*lag, 0.0, {&in, 1}), 3.0);
}

TEST(Delay, IsLeftToTheEngine) {
  const auto delay = Build("sensor", {{"type", "delay"}, {"delay_s", 3e-4}});
  ASSERT_NE(delay, nullptr);
  EXPECT_EQ(delay->delay_s(), 3e-4);
  EXPECT_EQ(Map("sensor", {{"type", "delay"}, {"delay_s", 3e-4}}, 4.0), 4.0);
}

TEST(Sensors, ValuesByHand) {
  EXPECT_EQ(Map("sensor", {{"type", "gain"}, {"gain", -1.5}}, 2.0), -3.0);
  EXPECT_EQ(Map("sensor", {{"type", "offset"}, {"offset", -0.5}}, 2.0), 1.5);
  EXPECT_EQ(Map("sensor", {{"type", "drift"}, {"slope_per_s", 0.25}}, 2.0, 8.0), 4.0);
  EXPECT_EQ(Map("sensor", {{"type", "rectified"}}, -2.0), 2.0);
  for (const auto& [in, out] : {std::pair{-3.0, -2.0}, {0.5, 0.5}, {7.0, 5.0}})
    EXPECT_EQ(Map("sensor", {{"type", "range"}, {"low", -2.0}, {"high", 5.0}}, in), out);
  EXPECT_EQ(Map("sensor", {{"type", "quantisation"}, {"step", 0.5}}, 1.2), 1.0);
  EXPECT_EQ(Map("sensor", {{"type", "quantisation"}, {"step", 0.5}}, -1.3), -1.5);
}

TEST(SensorNoise, BelongsToTheSample) {
  const auto noise = Build("sensor", {{"type", "noise"}, {"std", 2.0}}, {.period_s = 1e-3});
  ASSERT_NE(noise, nullptr);
  EXPECT_TRUE(noise->sampled());
  const double in = 10.0;
  for (int i = 1; i < 1000; ++i) {  // whichever way the tick's time was rounded
    const double tick = i * 1e-3;
    ASSERT_EQ(OutputOf(*noise, std::nextafter(tick, 0.0), {&in, 1}),
              OutputOf(*noise, std::nextafter(tick, 2.0), {&in, 1}));
  }
  constexpr int kSamples = 20000;
  double mean = 0.0, square = 0.0;
  for (int i = 0; i < kSamples; ++i) {
    const double x = OutputOf(*noise, i * 1e-3, {&in, 1}) - in;
    mean += x / kSamples;
    square += x * x / kSamples;
  }
  // Four standard errors.
  EXPECT_NEAR(mean, 0.0, 4 * 2.0 / std::sqrt(kSamples));
  EXPECT_NEAR(square, 4.0, 4 * 4.0 * std::sqrt(2.0 / kSamples));
}

TEST(Stages, ReportWhatIsOutOfRange) {
  std::string faults;
  EXPECT_EQ(Build("actuator", {{"type", "first_order_lag"}, {"tau_s", -1e-3}}, {}, &faults), nullptr);
  EXPECT_THAT(faults, ::testing::HasSubstr("\"tau_s\""));
  EXPECT_EQ(Build("sensor", {{"type", "quantisation"}, {"step", 0.0}}, {}, &faults), nullptr);
  EXPECT_THAT(faults, ::testing::HasSubstr("out of range"));
  EXPECT_EQ(Build("sensor", {{"type", "saturation"}, {"limit", 1.0}}, {}, &faults), nullptr);
  EXPECT_THAT(faults, ::testing::HasSubstr("there is no sensor \"saturation\""));
}

}  // namespace
}  // namespace dynoproof
