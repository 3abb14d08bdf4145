// The engine's controls tick by tick, its power train, its load and the synthetic cylinder: values by hand, limits,
// edges.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "tests/support/ticking.h"

namespace dynoproof {
namespace {

using testing::Build;
using testing::Ticking;

constexpr double kSpeed = 104.71975511965977;

Value Governor() {
  return {{"type", "engine_governor"}, {"k_P_kgs_per_rad", 2e-4}, {"k_I_kg_per_rad", 3e-4}, {"largest_kg", 3e-3},
          {"least_air_ratio", 1.5},    {"trip_rad_per_s", 120.0}, {"initial_kg", 1.4e-3}};
}

TEST(EngineGovernor, StartsWithoutABumpAndAddsUp) {
  Ticking governor(Governor());
  EXPECT_NEAR(governor.Tick({kSpeed, kSpeed - 1.0, 0.1})[0], 1.4e-3, 1e-18);
  EXPECT_NEAR(governor.Tick({kSpeed, kSpeed, 0.1})[0], 1.4e-3 - 2e-4 + 0.01 * 3e-4, 1e-15);
}

TEST(EngineGovernor, GivesNoMoreThanTheAirBearsAndDoesNotWindUp) {
  Ticking governor(Governor());
  governor.Tick({kSpeed, kSpeed, 0.04});
  for (int n = 0; n < 1000; ++n) governor.Tick({kSpeed, kSpeed - 5.0, 0.04});
  EXPECT_NEAR(governor.outputs[0], 0.04 / (16.8 * 1.5), 1e-15);
  // Ten ticks of the other sign take it off the limit: nothing had to unwind.
  for (int n = 0; n < 10; ++n) governor.Tick({kSpeed, kSpeed + 1.0, 0.04});
  EXPECT_LT(governor.outputs[0], 1.5e-3);
  for (int n = 0; n < 1000; ++n) governor.Tick({kSpeed, kSpeed - 5.0, 1.0});
  EXPECT_EQ(governor.outputs[0], 3e-3) << "its own limit";
  for (int n = 0; n < 3000; ++n) governor.Tick({kSpeed, kSpeed + 5.0, 1.0});
  EXPECT_EQ(governor.outputs[0], 0.0);
}

TEST(EngineGovernor, TripsAtOverspeedForGood) {
  Ticking governor(Governor());
  EXPECT_GT(governor.Tick({kSpeed, 119.9, 0.1})[0], 0.0);
  EXPECT_EQ(governor.Tick({kSpeed, 120.1, 0.1})[0], 0.0);
  for (int n = 0; n < 100; ++n) EXPECT_EQ(governor.Tick({kSpeed, 0.0, 0.1})[0], 0.0);
}

TEST(NoxControl, ClosesTheBlowOffWhenThereIsTooMuchAndStopsAtItsEnds) {
  const Value table = {
      {"type", "nox_control"}, {"k_P_percent", 5.0}, {"k_I_percent_per_s", 5.0}, {"initial_percent", 20.0}};
  Ticking control(table);
  EXPECT_EQ(control.Tick({1.0})[0], 20.0);
  control.Tick({1.5});
  EXPECT_NEAR(control.Tick({1.5})[0], 20.0 - 0.5 * 5.0 - 0.5 * 5.0 * 0.01, 1e-12);
  for (int n = 0; n < 1000; ++n) control.Tick({50.0});  // counts as twice the limit
  EXPECT_EQ(control.outputs[0], 0.0);
  for (int n = 0; n < 10; ++n) control.Tick({0.0});
  EXPECT_GT(control.outputs[0], 5.0) << "did not wind up";
  for (int n = 0; n < 5000; ++n) control.Tick({0.0});
  EXPECT_EQ(control.outputs[0], 100.0);
}

TEST(KnockControl, RetardsInStepsAndComesBackSlowly) {
  Ticking control({{"type", "knock_control"}, {"step_deg", 0.5}, {"recovery_deg_per_s", 2.0}, {"largest_deg", 3.0}});
  EXPECT_EQ(control.Tick({0.3})[0], 0.0);
  EXPECT_EQ(control.Tick({1.2})[0], 0.5);
  EXPECT_NEAR(control.Tick({0.9})[0], 0.48, 1e-12);
  for (int n = 0; n < 20; ++n) control.Tick({2.0});
  EXPECT_EQ(control.outputs[0], 3.0);
  for (int n = 0; n < 200; ++n) control.Tick({0.0});
  EXPECT_EQ(control.outputs[0], 0.0);
}

TEST(VoltageControl, FallsWithTheSpeedBelowItsKnee) {
  Value table = {{"type", "voltage_control"}, {"rated_V", 1e4}, {"rated_rad_per_s", 100.0},
                 {"knee_rad_per_s", 99.0},    {"slope", 3.0},   {"least", 0.7}};
  Ticking direct(table);
  EXPECT_EQ(direct.Tick({100.0})[0], 1e4);
  EXPECT_EQ(direct.Tick({99.0})[0], 1e4);
  EXPECT_NEAR(direct.Tick({98.0})[0], 1e4 * 0.97, 1e-9);
  EXPECT_NEAR(direct.Tick({10.0})[0], 7e3, 1e-9);
  table["lag_s"] = Value(0.1);
  Ticking lagged(table);
  EXPECT_EQ(lagged.Tick({100.0})[0], 1e4) << "no bump";
  for (int n = 1; n <= 30; ++n) {
    EXPECT_NEAR(lagged.Tick({98.0})[0], 1e4 - 300.0 * (1.0 - std::exp(-0.1 * n)), 1e-8);
  }
}

TEST(EngineControls, HideNothingThatIsNoNumber) {
  const double nan = std::nan("");
  EXPECT_TRUE(std::isnan(Ticking(Governor()).Tick({kSpeed, nan, 0.1})[0]));
  EXPECT_TRUE(std::isnan(
      Ticking({{"type", "nox_control"}, {"k_P_percent", 5.0}, {"k_I_percent_per_s", 5.0}, {"initial_percent", 20.0}})
          .Tick({nan})[0]));
  EXPECT_TRUE(std::isnan(Ticking({{"type", "knock_control"}}).Tick({nan})[0]));
  EXPECT_TRUE(std::isnan(
      Ticking({{"type", "voltage_control"}, {"rated_V", 1e4}, {"rated_rad_per_s", 100.0}, {"knee_rad_per_s", 99.0}})
          .Tick({nan})[0]));
}

TEST(ResistorLoad, TakesItsPowerAndStopsWithTheShaft) {
  const auto load = Build("plant", {{"type", "resistor_load"}, {"efficiency", 0.97}, {"least_speed_rad_per_s", 50.0}});
  const auto at = [&](double speed) {
    const double inputs[] = {1e4, 0.04, speed};
    std::vector<double> outputs(2);
    load->Output({0.0, inputs, {}, {}}, outputs);
    return outputs;
  };
  EXPECT_NEAR(at(100.0)[0], 4e6, 1e-6);
  EXPECT_NEAR(at(100.0)[1], 4e4 / 0.97, 1e-6);
  EXPECT_NEAR(at(25.0)[0], 1e6, 1e-6);
  for (const double speed : {-100.0, -20.0, 10.0, 49.999, 50.001, 200.0}) {
    EXPECT_NEAR(at(speed)[1] * speed * 0.97, at(speed)[0], 1e-6) << speed;
  }
  EXPECT_EQ(at(0.0)[1], 0.0);
}

std::vector<double> TrainRates(const char* operation, double torque, double work, double load, double speed) {
  const auto train = Build("plant", {{"type", "power_train"},
                                     {"operation", operation},
                                     {"inertia_kg_m2", 2000.0},
                                     {"friction_Nm", 4000.0},
                                     {"friction_Nms_per_rad", 40.0},
                                     {"start_speed_rad_per_s", speed}});
  const double inputs[] = {torque, work, load};
  std::vector<double> states(train->layout().states.size()), rates(states.size());
  train->Start(inputs, states, {});
  train->Derivative({0.0, inputs, states, {}}, rates);
  return rates;
}

TEST(PowerTrain, SpeedChangesByTheTorqueThatIsLeft) {
  const double indicated = 1500.0 + 20.0 * 2.8e4 / (4.0 * std::numbers::pi), friction = 4000.0 + 40.0 * kSpeed;
  const double before = TrainRates("island", 1500.0, 2.8e4, 3.7e4, kSpeed)[1];
  EXPECT_NEAR(before, (indicated - friction - 3.7e4) / 2000.0, 1e-10);
  EXPECT_NEAR(TrainRates("island", 1500.0, 2.8e4, 4.9e4, kSpeed)[1] - before, -1.2e4 / 2000.0, 1e-12) << "-dT/I";
}

TEST(PowerTrain, GridTakesWhatIsLeft) {
  const std::vector<double> rates = TrainRates("grid", 1500.0, 2.8e4, 9e9, kSpeed);
  EXPECT_EQ(rates[0], kSpeed);
  EXPECT_EQ(rates[1], 0.0);
  EXPECT_NEAR(rates[2], rates[3], 1e-6) << "all that comes in goes out";
}

TEST(PowerTrain, StandsStillWithoutTorque) {
  for (const double rate : TrainRates("island", 0.0, 0.0, 0.0, 0.0)) EXPECT_EQ(rate, 0.0);
  for (const double rate : TrainRates("island", 0.0, -2e3, 0.0, 0.0)) EXPECT_EQ(rate, 0.0) << "no cycle at rest";
  EXPECT_GT(TrainRates("island", 0.0, 0.0, 0.0, -5.0)[1], 0.0) << "friction brakes both ways";
}

TEST(FiredCylinder, TellsMixtureKnockAndNox) {
  const auto sce = Build("plant", {{"type", "fired_cylinder"},
                                   {"bore_m", 0.31},
                                   {"stroke_m", 0.35},
                                   {"rod_m", 0.75},
                                   {"compression_ratio", 12.0},
                                   {"intake_closes_deg", 165.0},
                                   {"exhaust_opens_deg", 490.0}});
  ASSERT_NE(sce, nullptr);
  const auto at = [&](double fuel, double retard) {
    const double inputs[] = {0.045, 330.0, 1.95e5, fuel, retard};
    std::vector<double> outputs(6);
    sce->Output({0.0, inputs, {}, {}}, outputs);
    return outputs;
  };
  const auto fired = at(1.4e-3, 0.0), late = at(1.4e-3, 10.0), none = at(0.0, 0.0), rich = at(1.7e-3, 0.0);
  EXPECT_NEAR(fired[3], 0.045 / (16.8 * 1.4e-3), 1e-12);
  EXPECT_EQ(none[3], 10.0);
  EXPECT_LT(none[1], 0.0) << "a motored cycle takes work: its heat capacities differ";
  EXPECT_LT(late[1], fired[1]);
  EXPECT_GT(late[0], fired[0]);
  EXPECT_LT(late[4], fired[4]) << "later burning knocks less";
  EXPECT_GT(rich[4], fired[4]);
  EXPECT_NEAR(std::log(rich[5] / fired[5]), 12.0 * (fired[3] - rich[3]), 1e-9);
  EXPECT_NEAR(std::log(late[5] / fired[5]), -1.0, 1e-9);
}

TEST(FiredCylinder, HidesNothingThatIsNoNumber) {
  const auto sce = Build("plant", {{"type", "fired_cylinder"},
                                   {"bore_m", 0.31},
                                   {"stroke_m", 0.35},
                                   {"rod_m", 0.75},
                                   {"compression_ratio", 12.0},
                                   {"intake_closes_deg", 165.0},
                                   {"exhaust_opens_deg", 490.0}});
  for (int bad = 0; bad < 5; ++bad) {
    double inputs[] = {0.045, 330.0, 1.95e5, 1.4e-3, 0.0};
    inputs[bad] = std::nan("");
    std::vector<double> outputs(6);
    sce->Output({0.0, inputs, {}, {}}, outputs);
    EXPECT_TRUE(std::any_of(outputs.begin(), outputs.end(), [](double value) { return std::isnan(value); })) << bad;
  }
}

TEST(FiredCylinder, RefusesHeatOutsideOfTheClosedPart) {
  std::string faults;
  EXPECT_EQ(Build("plant",
                  {{"type", "fired_cylinder"},
                   {"bore_m", 0.31},
                   {"stroke_m", 0.35},
                   {"rod_m", 0.75},
                   {"compression_ratio", 12.0},
                   {"intake_closes_deg", 165.0},
                   {"exhaust_opens_deg", 365.0}},
                  {}, &faults),
            nullptr);
  EXPECT_THAT(faults, ::testing::HasSubstr("lies outside of the closed part"));
}

}  // namespace
}  // namespace dynoproof
