// What a real drive adds to the loop with the machine: `encoder` and `inverter` against their equations.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <complex>
#include <numbers>

#include "plugins/control/inverter/inverter.h"
#include "tests/support/build.h"

namespace dynoproof {
namespace {

TEST(Inverter, TakesTheMeanOfItsDeadTimeByTheSignOfThePhaseCurrents) {
  const controls::Inverter inverter(
      {.dc_link_V = 600.0, .dead_time_s = 2e-6, .switching_period_s = 1e-4, .soft_current_A = 1e-9});
  // A turn of the current: the missing voltage has the length 4/3 0.02 600 V and lies within 30 degrees of it.
  for (int degrees = 5; degrees < 360; degrees += 10) {
    const std::complex<double> current = std::polar(100.0, degrees * std::numbers::pi / 180.0);
    const std::array inputs = {10.0, -20.0, current.real(), current.imag()};
    std::array<double, 2> outputs{};
    inverter.Tick({0.0, inputs, {}, {}}, {}, outputs);
    const std::complex<double> missing(10.0 - outputs[0], -20.0 - outputs[1]);
    EXPECT_NEAR(std::abs(missing), 4.0 / 3.0 * 0.02 * 600.0, 1e-12) << degrees;
    EXPECT_LE(std::abs(std::arg(missing / current)), std::numbers::pi / 6.0) << degrees;
  }
}

TEST(Inverter, FallsOffBelowItsSoftCurrentAndRefusesADeadTimeThatLeavesNoPulse) {
  const controls::Inverter inverter(
      {.dc_link_V = 600.0, .dead_time_s = 2e-6, .switching_period_s = 1e-4, .soft_current_A = 20.0});
  const std::array inputs = {0.0, 0.0, 4.0, 0.0};  // phases 4, -2, -2 A
  std::array<double, 2> outputs{};
  inverter.Tick({0.0, inputs, {}, {}}, {}, outputs);
  EXPECT_NEAR(outputs[0], -0.02 * 600.0 * 4.0 / 20.0, 1e-12);
  EXPECT_EQ(outputs[1], 0.0);
  Diagnostics diagnostics;
  controls::Inverter::Params params;
  const Value table{{"dc_link_V", 600.0}, {"dead_time_s", 6e-5}};
  EXPECT_FALSE(ReadParams(table, params, diagnostics, "control.inverter"));
}

TEST(Encoder, CountsStepsAndTakesBackWhatAPeriodIsWrongBy) {
  const Value table{{"type", "encoder"}, {"steps_per_turn", 4096.0}, {"initial_speed_rad_per_s", 7.0}};
  const std::unique_ptr<Component> encoder = testing::Build("control", table);  // ticks with 100 us
  ASSERT_NE(encoder, nullptr);
  const double step = 2.0 * std::numbers::pi / 4096.0;
  std::array<double, 2> states{};
  std::array<double, 1> outputs{};
  double angle = 0.3, sum = 0.0;
  const double first = angle;
  for (int n = 0; n < 1000; ++n) {
    const std::array inputs = {angle};
    encoder->Tick({0.0, inputs, {}, {}}, states, outputs);
    if (n == 0) {
      EXPECT_EQ(outputs[0], 7.0);
    } else {
      EXPECT_NEAR(std::remainder(outputs[0] * 1e-4, step), 0.0, 1e-12);  // a whole number of steps
      sum += outputs[0] * 1e-4;
      EXPECT_LE(std::abs(sum - (angle - first)), step * (1.0 + 1e-9)) << n;
    }
    angle += 1e-4 * (10.0 - 0.02 * n);  // to and fro
  }
}

}  // namespace
}  // namespace dynoproof
