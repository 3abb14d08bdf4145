// The pressure controllers tick by tick: bumpless start, conditioning with both signs, decoupling, limits, edges.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "plugins/control/pressure_pi/conditioned_pi.h"
#include "plugins/physics/gas_flow.h"
#include "tests/support/ticking.h"

namespace dynoproof {
namespace {

using testing::Build;
using testing::Ticking;

Value Pi(const char* anti_windup) {
  return {{"type", "pressure_pi"}, {"k_P", 0.5},          {"k_I_per_s", 2.0},          {"k_F", 1.0},
          {"largest_Pa", 4e5},     {"initial_Pa", 3.1e5}, {"anti_windup", anti_windup}};
}

TEST(PressurePi, StartsWithoutABumpAndAddsUp) {
  Ticking control(Pi("conditioned"));
  EXPECT_EQ(control.Tick({3e5, 2.9e5})[0], 3.1e5);
  // One tick later: the integral has k_I e T = 2 1e4 0.01 = 200 Pa more; the proportional part has gone.
  EXPECT_NEAR(control.Tick({3e5, 3e5})[0], 3.1e5 + 200.0 - 0.5 * 1e4, 1e-9);
}

TEST(PressurePi, ConditioningUnwindsAndThePrintedSignRunsAway) {
  // Held at the upper limit by an error that stays: the conditioned integral comes to rest where the command is at the
  // limit as far as k_P + k_F sees it, w - w^ = (k_P + k_F) e; without it it grows, with the printed sign faster.
  double wanted[3];
  const char* names[] = {"conditioned", "none", "as_printed"};
  for (int i = 0; i < 3; ++i) {
    Ticking control(Pi(names[i]));
    for (int k = 0; k < 3000; ++k) {
      EXPECT_LE(control.Tick({3.9e5, 3.0e5})[0], 4e5);
    }
    wanted[i] = control.outputs[1];
  }
  EXPECT_NEAR(wanted[0], 4e5 + 1.5 * 0.9e5, 1.0);
  EXPECT_GT(wanted[1], 4e5 + 50.0 * 0.9e5);
  EXPECT_GT(wanted[2], 10.0 * wanted[1]);
}

TEST(PressurePi, RefusesWhatCannotWork) {
  std::string faults;
  Value table = Pi("conditioned");
  table["k_P"] = Value(0.0);
  table["k_F"] = Value(0.0);
  table["least_Pa"] = Value(5e5);
  EXPECT_EQ(Build("control", table, {}, &faults), nullptr);
  EXPECT_THAT(faults, ::testing::HasSubstr("divides by k_P + k_F = 0"));
  EXPECT_THAT(faults, ::testing::HasSubstr("no room between the limits"));
}

Value Air() {
  return {{"type", "charge_air_control"},
          {"volume_1_m3", 0.4},
          {"volume_2_m3", 1.2},
          {"displacement_m3", 0.0264},
          {"volumetric_efficiency", 0.9},
          {"largest_p_s_Pa", 6.5e5},
          {"flap", Value{{"1", Value{{"area_span_m2", 9e-3}}}, {"2", Value{{"area_span_m2", 4.5e-3}}}}}};
}

constexpr double kSpeed = 104.72;

TEST(ChargeAirControl, GivesTheFlowsThatItWants) {
  Ticking control(Air());
  const mechanics::Gas air;
  const auto one = mechanics::FlapArea::Cosine(1e-5, 9e-3), two = mechanics::FlapArea::Cosine(1e-5, 4.5e-3);
  EXPECT_NEAR(control.Tick({3e5, 3e5, 4.5e5, kSpeed})[0], 25.0, 1e-9) << "no bump";
  EXPECT_NEAR(control.outputs[1], 50.0, 1e-9);
  const double q_2 = mechanics::OrificeFlow(air, two.Area(50.0), 4.5e5, 101300.0);
  EXPECT_NEAR(-control.outputs[4] - control.outputs[3], q_2, 1e-12);
  control.Tick({3.02e5, 3e5, 4.5e5, kSpeed});  // (6.15): the plant's flow at that position is w_1
  EXPECT_NEAR(mechanics::OrificeFlow(air, one.Area(control.outputs[0]), 4.5e5, 3e5), control.outputs[3], 1e-12);
}

TEST(ChargeAirControl, TellsFlapTwoOfTheFlowThatFlapOneGives) {
  Ticking control(Air());
  control.Tick({3e5, 3e5, 4.5e5, kSpeed});
  const std::vector<double> free = control.Tick({3e5, 3e5, 4.5e5, kSpeed});
  const std::vector<double> held = control.Tick({9e5, 3e5, 4.5e5, kSpeed});  // far beyond what flap 1 can give
  EXPECT_DOUBLE_EQ(held[0], 50.0);                                           // by way of a cosine and back
  // q_1 + q_2 = -w_2 all the same: what flap 1 takes more, flap 2 gives less.
  const mechanics::Gas air;
  const auto one = mechanics::FlapArea::Cosine(1e-5, 9e-3), two = mechanics::FlapArea::Cosine(1e-5, 4.5e-3);
  const auto sum = [&](const std::vector<double>& u) {
    return mechanics::OrificeFlow(air, one.Area(u[0]), 4.5e5, 3e5) +
           mechanics::OrificeFlow(air, two.Area(u[1]), 4.5e5, 101300.0);
  };
  EXPECT_NEAR(sum(free), -free[4], 1e-12);
  EXPECT_NEAR(sum(held), std::max(-held[4], sum({50.0, 0.0})), 1e-12);
}

TEST(ChargeAirControl, PlansWithinItsLimits) {
  Ticking control(Air());
  const double K = control.Tick({3e5, 3e5, 4.5e5, kSpeed})[2] / 3e5 - 1.0;
  EXPECT_NEAR(K,
              std::pow(0.9 * 0.0264 * kSpeed / (4.0 * std::acos(-1.0)) /
                           (mechanics::FlapArea::Cosine(1e-5, 9e-3).Area(25.0) * std::sqrt(2.0 * 287.05 * 320.0)),
                       2.0),
              1e-12);
  EXPECT_EQ(control.Tick({3e5, 6e5, 6.1e5, kSpeed})[2], 6.5e5) << "the compressor's limit";
  EXPECT_NEAR(control.Tick({3e5, 3e5, 4.5e5, 3.0 * kSpeed})[2], 1.95 * 3e5, 1e-9) << "(6.7) where K > 1";
}

TEST(ChargeAirControl, HasAnAnswerWithoutAPressureDrop) {
  for (const double p_s : {3e5, 2e5, 0.0}) {
    for (const auto& [reference, position] : {std::pair(9e5, 50.0), std::pair(1e4, 0.0)}) {
      Ticking control(Air());
      control.Tick({3e5, 3e5, p_s, kSpeed});
      EXPECT_EQ(control.Tick({reference, 3e5, p_s, kSpeed})[0], position) << p_s;
      for (const double output : control.outputs) EXPECT_TRUE(std::isfinite(output));
    }
  }
}

TEST(ChargeAirLegacy, RefusesFlapsWithoutARange) {
  std::string faults;
  const Value table{{"type", "charge_air_legacy"},   {"k_P_percent_per_bar", 20.0}, {"k_I_percent_per_bar_s", 4.0},
                    {"u_2_rate_percent_per_s", 1.0}, {"u_1_least_percent", 60.0},   {"u_2_largest_percent", 0.0}};
  EXPECT_EQ(Build("control", table, {}, &faults), nullptr);
  EXPECT_THAT(faults, ::testing::HasSubstr("flap 1 has no range"));
  EXPECT_THAT(faults, ::testing::HasSubstr("flap 2 has no range"));
}

TEST(ChargeAirLegacy, MovesFlapTwoOnlyWhileFlapOneIsAtALimit) {
  Ticking control(Value{{"type", "charge_air_legacy"},
                        {"k_P_percent_per_bar", 20.0},
                        {"k_I_percent_per_bar_s", 4.0},
                        {"u_2_rate_percent_per_s", 1.0}});
  EXPECT_EQ(control.Tick({3e5, 3e5}), (std::vector<double>{25.0, 50.0}));
  EXPECT_NEAR(control.Tick({3.5e5, 3e5})[0], 35.0, 1e-12);
  EXPECT_EQ(control.outputs[1], 50.0);
  for (int k = 0; k < 101; ++k) control.Tick({6e5, 3e5});
  EXPECT_EQ(control.outputs[0], 50.0);
  EXPECT_NEAR(control.outputs[1], 49.0, 1e-9);  // closed for 100 ticks of 0.01 s at 1 %/s
  control.Tick({1e5, 5e5});
  EXPECT_EQ(control.outputs[0], 0.0) << "the integral did not wind up";
  control.Tick({1e5, 5e5});
  EXPECT_GT(control.outputs[1], 48.99);
}

}  // namespace
}  // namespace dynoproof
