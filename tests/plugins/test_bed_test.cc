// The parts of the single-cylinder test bed: breathing, injection and combustion against closed forms, the pipe behind it,
// its flaps' control, books, evaluation, positioners and warm resistors; edges.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "plugins/physics/gas_exchange.h"
#include "plugins/plant/back_pressure/back_pressure.h"
#include "plugins/plant/breathing_cylinder/breathing_cylinder.h"
#include "plugins/plant/fired_cylinder/fired_cycle.h"
#include "tests/support/ticking.h"

namespace dynoproof {
namespace {

using testing::Build;
using testing::Ticking;

constexpr double kDegree = std::numbers::pi / 180.0, kSpeed = 104.71975511965977, kHeat = 47e6;
constexpr CylinderGeometry kGeometry{0.31, 0.35, 0.75, 12.0};

Value Cylinder() {
  return {
      {"type", "breathing_cylinder"},
      {"bore_m", 0.31},
      {"stroke_m", 0.35},
      {"rod_m", 0.75},
      {"compression_ratio", 12.0},
      {"wall_factor", 0.0},
      {"injection_area_m2", 3.8e-4},
      {"injection_opens_deg", 25.0},
      {"start_p_evo_Pa", 5e5},
      {"start_work_J", 2e4},
      {"valves",
       Value{
           {"intake", Value{{"diameter_m", 0.10}, {"lift_m", 0.024}, {"opens_deg", -20.0}, {"closes_deg", 165.0}}},
           {"exhaust", Value{{"diameter_m", 0.095}, {"lift_m", 0.024}, {"opens_deg", 490.0}, {"closes_deg", 740.0}}}}}};
}

/// A part on its own, its inputs held but for the angle, carried by Runge-Kutta 4.
struct Alone {
  std::unique_ptr<Component> part;
  std::vector<double> inputs, states;
  std::vector<int> modes;
  int angle;  // input that turns with the one behind it; -1: none

  Alone(const Value& table, std::vector<double> with, int turning = -1)
      : part(Build("plant", table)), inputs(std::move(with)), angle(turning) {
    states.assign(part->layout().states.size(), 0.0);
    modes.assign(static_cast<std::size_t>(part->layout().modes), 0);
    part->Start(inputs, states, modes);
  }
  void Step(double h) {
    const double share[4] = {0.0, 0.5, 0.5, 1.0}, weight[4] = {1.0, 2.0, 2.0, 1.0};
    const double begin = angle < 0 ? 0.0 : inputs[static_cast<std::size_t>(angle)];
    std::vector<double> x = states, sum(states.size(), 0.0), rates(states.size(), 0.0);
    for (int k = 0; k < 4; ++k) {
      for (std::size_t i = 0; i < x.size(); ++i) x[i] = states[i] + share[k] * h * rates[i];
      if (angle >= 0)
        inputs[static_cast<std::size_t>(angle)] = begin + share[k] * h * inputs[static_cast<std::size_t>(angle) + 1];
      part->Derivative({0.0, inputs, x, modes}, rates);
      for (std::size_t i = 0; i < x.size(); ++i) sum[i] += weight[k] * rates[i];
    }
    for (std::size_t i = 0; i < x.size(); ++i) states[i] += h / 6.0 * sum[i];
    part->OnEvent({0.0, inputs, states, modes}, -1, states, modes);
  }
  std::vector<double> Outputs() const {
    std::vector<double> outputs(part->layout().outputs.size());
    part->Output({0.0, inputs, states, modes}, outputs);
    return outputs;
  }
};

/// The cylinder at an angle, with charge and exhaust pipes at rest.
Alone Engine(const Value& table, double degrees, double fuel = 1.4e-3) {
  std::vector<double> inputs(12, 0.0);
  inputs[BreathingCylinder::kAngle] = degrees * kDegree;
  inputs[BreathingCylinder::kSpeed] = kSpeed;
  inputs[BreathingCylinder::kChargePressure] = inputs[BreathingCylinder::kChargeReference] = 2e5;
  inputs[BreathingCylinder::kChargeTheta] = 320.0;
  inputs[BreathingCylinder::kExhaustPressure] = 1.7e5;
  inputs[BreathingCylinder::kExhaustTheta] = 790.0;
  inputs[BreathingCylinder::kGasPressure] = inputs[BreathingCylinder::kGasReference] = 3e5;
  inputs[BreathingCylinder::kFuel] = fuel;
  return {table, inputs, BreathingCylinder::kAngle};
}

TEST(BreathingCylinder, ComesToTheIdealCycleAsItBurnsFaster) {
  // From a closed intake to an open exhaust without walls: the same air and fuel through FiredCycle, whose heat is
  // released at once. The difference goes to 0 with the duration, in which the gas has neither heat capacity ratio.
  double off[2];
  for (int i = 0; i < 2; ++i) {
    Value table = Cylinder();
    const double burn = i == 0 ? 5.0 : 2.5;
    table["burn_deg"] = Value(burn);
    Alone engine = Engine(table, 170.0);
    const double p = engine.Outputs()[BreathingCylinder::kPressure];
    // Carried back to the closing intake, whose charge the cylinder begins with.
    const double v_1 = kGeometry.Volume(165.0 * kDegree), v_4 = kGeometry.Volume(490.0 * kDegree);
    const double p_1 = p * std::pow(kGeometry.Volume(170.0 * kDegree) / v_1, 1.39);
    while (engine.inputs[0] < 491.0 * kDegree) engine.Step(1e-5);
    const auto ideal = mechanics::FiredCycle{1.39, 1.33, kHeat, 0.0}.Run(p_1, 320.0, v_1,
                                                                         kGeometry.Volume(10.0 * kDegree), v_4, 1.4e-3);
    const std::vector<double> outputs = engine.Outputs();
    off[i] = outputs[BreathingCylinder::kEvoPressure] / ideal.pressure_end - 1.0;
    // The work since the start at 170 degrees: 5 degrees of compression are missing, p_1 (V_1 - V) to first order.
    const double work = ideal.work - 101300.0 * (v_4 - v_1);
    EXPECT_NEAR(outputs[BreathingCylinder::kWork] / work, 1.0, 0.01) << burn;
    EXPECT_EQ(outputs[BreathingCylinder::kTrappedFuel], 1.4e-3);
  }
  EXPECT_LT(std::abs(off[1]), 2e-4);  // 1.1e-4 is seen, 1.6e-4 with 5 degrees
  EXPECT_LT(std::abs(off[1]), 0.8 * std::abs(off[0]));
}

TEST(BreathingCylinder, KeepsMassAndEnergyOverACycle) {
  Value table = Cylinder();
  table["wall_factor"] = Value(1.0);
  Alone engine = Engine(table, 0.0);
  const std::vector<double> begin = engine.Outputs();
  double mass = 0.0, energy = 0.0;
  const double h = 2e-5;
  std::vector<double> before = begin;
  double burnt = 0.0;
  for (int n = 0; n < 12000; ++n) {  // two cycles; trapezoids of what crosses the border
    engine.Step(h);
    const std::vector<double> now = engine.Outputs();
    const auto mean = [&](int output) { return 0.5 * h * (before[output] + now[output]); };
    mass += mean(BreathingCylinder::kAirFlow) + mean(BreathingCylinder::kFuelFlow) -
            mean(BreathingCylinder::kExhaustAirFlow) - mean(BreathingCylinder::kExhaustGasFlow);
    energy += mean(BreathingCylinder::kEnergyIn) - mean(BreathingCylinder::kExhaustEnthalpy);
    burnt += mean(BreathingCylinder::kFuelFlow);
    before = now;
  }
  // Kinks of the flows at the ends of the lifts, by trapezoids of 20 us: 1e-6 of what went through.
  EXPECT_NEAR(before[BreathingCylinder::kMass] - begin[BreathingCylinder::kMass], mass, 1e-6);
  EXPECT_NEAR(before[BreathingCylinder::kEnergy] - begin[BreathingCylinder::kEnergy], energy, 1.0);
  EXPECT_NEAR(burnt, 2.0 * 1.4e-3, 1e-6) << "the dose that was wanted, twice";
}

TEST(BreathingCylinder, ScavengesItsPreChamberWithAShareOfTheFuel) {
  Value table = Cylinder();
  table["prechamber_share"] = Value(0.03);
  Alone engine = Engine(table, 0.0);
  double through_valve = 0.0, through_chamber = 0.0;
  const double h = 5e-5;
  while (engine.inputs[0] < 166.0 * kDegree) {
    const std::vector<double> before = engine.Outputs();
    engine.Step(h);
    const std::vector<double> now = engine.Outputs();
    through_valve += 0.5 * h * (before[BreathingCylinder::kFuelFlow] + now[BreathingCylinder::kFuelFlow]);
    through_chamber += 0.5 * h * (before[BreathingCylinder::kPrechamberFlow] + now[BreathingCylinder::kPrechamberFlow]);
  }
  // Trapezoids of 0.3 degree; the edges of the gas valve have kinks.
  EXPECT_NEAR(through_chamber, 0.03 * 1.4e-3, 1e-5 * 1.4e-3);
  EXPECT_NEAR(through_valve, 0.97 * 1.4e-3, 1e-3 * 1.4e-3);
  EXPECT_NEAR(engine.Outputs()[BreathingCylinder::kTrappedFuel], 1.4e-3, 1e-3 * 1.4e-3);
}

TEST(BreathingCylinder, DosesByThePressuresThatAreWanted) {
  // Half of the pressure drop that the valve was timed for: the flow of (6.4) is smaller by the ratio of the two.
  const auto dose = [](double gas_pressure) {
    Alone engine = Engine(Cylinder(), 0.0);
    engine.inputs[BreathingCylinder::kGasPressure] = gas_pressure;
    while (engine.inputs[0] < 166.0 * kDegree) engine.Step(5e-5);
    return engine.Outputs()[BreathingCylinder::kTrappedFuel];
  };
  EXPECT_NEAR(dose(3e5), 1.4e-3, 1e-8);
  const double expected = std::sqrt(2e5 * 0.5e5) / std::sqrt(2e5 * 1e5);
  EXPECT_NEAR(dose(2.5e5) / dose(3e5), expected, 1e-6);
  EXPECT_EQ(dose(1.9e5) < 0.0, true) << "below the charge pressure it flows back";
}

TEST(BreathingCylinder, BurnsLaterWithRetardAndNotAtAllBackwards) {
  double p_evo[2], work[2];
  for (int i = 0; i < 2; ++i) {
    Alone engine = Engine(Cylinder(), 160.0);
    engine.states[3] = 1.4e-3;
    engine.inputs[BreathingCylinder::kRetard] = 8.0 * i;
    while (engine.inputs[0] < 491.0 * kDegree) engine.Step(5e-5);
    p_evo[i] = engine.Outputs()[BreathingCylinder::kEvoPressure];
    work[i] = engine.Outputs()[BreathingCylinder::kWork];
  }
  EXPECT_GT(p_evo[1], 1.01 * p_evo[0]);
  EXPECT_LT(work[1], work[0]);
  Alone back = Engine(Cylinder(), 400.0);
  back.inputs[BreathingCylinder::kSpeed] = -kSpeed;
  const double fuel = back.states[3];
  for (int n = 0; n < 1000; ++n) back.Step(1e-4);
  for (const double state : back.states) EXPECT_TRUE(std::isfinite(state));
  EXPECT_EQ(back.states[3], fuel);
}

TEST(BreathingCylinder, HidesNoInputThatIsNoNumber) {
  for (std::size_t bad = 0; bad < 12; ++bad) {
    Alone engine = Engine(Cylinder(), bad == BreathingCylinder::kExhaustAir ? 5.0 : 60.0);
    if (bad == BreathingCylinder::kExhaustTheta || bad == BreathingCylinder::kExhaustPressure ||
        bad == BreathingCylinder::kExhaustAir) {
      engine = Engine(Cylinder(), 700.0);
      engine.inputs[BreathingCylinder::kExhaustPressure] = 9e5;  // it flows back
    }
    if (bad == BreathingCylinder::kRetard) engine = Engine(Cylinder(), 164.9);
    engine.inputs[bad] = std::nan("");
    bool seen = false;
    for (int n = 0; n < 2400 && !seen; ++n) {
      engine.Step(1e-4);
      for (const double output : engine.Outputs()) seen = seen || std::isnan(output);
      if (bad == BreathingCylinder::kAngle || bad == BreathingCylinder::kSpeed) break;
    }
    EXPECT_TRUE(seen) << engine.part->layout().inputs[bad].name;
  }
}

TEST(BreathingCylinder, TellsItsFaults) {
  std::string faults;
  Value table = Cylinder();
  table["burn_deg"] = Value(120.0);
  table["heat_at_deg"] = Value(80.0);
  table["injection_opens_deg"] = Value(150.0);
  EXPECT_EQ(Build("plant", table, {}, &faults), nullptr);
  EXPECT_THAT(faults, ::testing::HasSubstr("it burns while valves are open"));
  EXPECT_THAT(faults, ::testing::HasSubstr("cannot open and close before the intake does"));
}

const Value kFlaps = {{"3", Value{{"area_span_m2", 4e-3}}}, {"4", Value{{"area_span_m2", 1e-3}}}};

TEST(BackPressure, EmptiesChokedAsTheClosedForm) {
  // m = m_0 (1 + (chi - 1)/2 k t)^(-2/(chi - 1)) while choked, k = A sqrt(R theta/2)/V.
  Alone pipe({{"type", "back_pressure"},
              {"volume_m3", 1.0},
              {"start_pressure_Pa", 4e5},
              {"start_theta_K", 800.0},
              {"flap", kFlaps}},
             {60.0, 30.0, 0.0, 0.0, 0.0});
  const double area =
      2e-5 + 4e-3 * (1.0 - std::cos(0.3 * std::numbers::pi)) + 1e-3 * (1.0 - std::cos(0.15 * std::numbers::pi));
  const double k = area * std::sqrt(0.5 * 290.0 * 800.0), mass = pipe.Outputs()[BackPressure::kMass];
  int choked = 0;
  for (int n = 1; n < 400; ++n) {
    pipe.Step(1e-3);
    const double part = std::pow(1.0 + 0.165 * k * 1e-3 * n, -2.0 / 0.33);
    if (4e5 * std::pow(part, 1.33) < 2.0 * 101300.0) break;
    ASSERT_NEAR(pipe.Outputs()[BackPressure::kMass] / mass, part, 1e-10);
    ASSERT_NEAR(pipe.Outputs()[BackPressure::kPressure] / (4e5 * std::pow(part, 1.33)), 1.0, 1e-10);
    ++choked;
  }
  EXPECT_GT(choked, 50);
}

TEST(BackPressure, MixesWhatComesIn) {
  Alone pipe({{"type", "back_pressure"},
              {"volume_m3", 1.0},
              {"start_pressure_Pa", 2e5},
              {"start_theta_K", 800.0},
              {"flap", kFlaps}},
             {0.0, 0.0, 0.0, 0.0, 0.0});
  pipe.inputs = {0.0, 0.0, 0.2, 0.1, 0.2 * 1023.1 * 350.0};
  const std::vector<double> begin = pipe.Outputs();
  for (int n = 0; n < 100; ++n) pipe.Step(1e-2);
  const std::vector<double> end = pipe.Outputs();
  // 0.2 of the 0.3 kg that came to 0.86 kg of exhaust gas; what the closed flaps let out has changed that a little.
  EXPECT_NEAR(end[BackPressure::kAir], 0.2 / (0.3 + 2e5 / (290.0 * 800.0)), 2e-3);
  EXPECT_LT(end[BackPressure::kTheta], 800.0);
  EXPECT_NEAR(end[BackPressure::kMass] - begin[BackPressure::kMass], 0.3, 0.02) << "closed flaps leak a little";
}

TEST(BackPressureControl, HoldsTheFlowThatComesAndCentresTheSmallFlap) {
  // A pipe at constant temperature with a constant flow in: the pressure goes to its set point, the small flap to the middle.
  const Value table = {
      {"type", "back_pressure_control"}, {"volume_m3", 1.0}, {"initial_u_3_percent", 40.0}, {"flap", kFlaps}};
  Ticking control(table);
  const mechanics::FlapArea large = mechanics::FlapArea::Cosine(1e-5, 4e-3),
                            small = mechanics::FlapArea::Cosine(1e-5, 1e-3);
  const mechanics::Gas gas{290.0, 750.0};
  double pressure = 2e5, highest = 0.0;
  for (int n = 0; n < 6000; ++n) {  // ticks of 10 ms
    const std::vector<double> u = control.Tick({1.6e5, pressure});
    const double area = large.Area(u[0]) + small.Area(u[1]);
    pressure += 0.01 * 1.33 * 290.0 * 750.0 * (0.45 - mechanics::OrificeFlow(gas, area, pressure, 101300.0));
    if (n > 300) highest = std::max(highest, std::abs(pressure - 1.6e5));
  }
  EXPECT_NEAR(pressure, 1.6e5, 1.0);
  EXPECT_LT(highest, 600.0) << "1 % of the step, 3 s behind it";
  EXPECT_NEAR(control.outputs[1], 50.0, 0.1);
  EXPECT_TRUE(std::isnan(control.Tick({1.6e5, std::nan("")})[1]));
}

TEST(Balance, SeesAFlowThatNobodyTakes) {
  const Value table = {{"type", "balance"},
                       {"stored", std::vector<Value>{Value("pipe")}},
                       {"in", std::vector<Value>{Value("a")}},
                       {"out", std::vector<Value>{Value("b"), Value("c")}}};
  Alone books(table, {5.0, 2.0, 0.5, 0.5});
  for (int n = 1; n <= 10; ++n) {
    books.Step(0.1);
    books.inputs[0] += 0.1;  // stored as the flows say
  }
  EXPECT_NEAR(books.Outputs()[0], 0.0, 1e-15);
  books.inputs[0] += 0.07;
  EXPECT_NEAR(books.Outputs()[0], 0.07 / 7.0, 1e-14);
  std::string faults;
  Value twice = table;
  twice["out"] = Value(std::vector<Value>{Value("a")});
  EXPECT_EQ(Build("plant", twice, {}, &faults), nullptr);
  EXPECT_THAT(faults, ::testing::HasSubstr("\"a\" is there twice"));
}

TEST(Indication, IsLateByAPeriod) {
  const Value table = {{"type", "indication"}};
  Ticking control(table);
  EXPECT_EQ(control.Tick({5e5, 2e4})[0], 5e5) << "nothing was seen before";
  EXPECT_EQ(control.Tick({6e5, 3e4})[0], 5e5);
  EXPECT_EQ(control.Tick({7e5, 4e4})[1], 3e4);
}

TEST(GasReference, StandsAboveTheCharge) {
  const Value table = {{"type", "gas_reference"}, {"difference_Pa", 1e5}};
  Ticking control(table);
  EXPECT_EQ(control.Tick({1.8e5})[0], 2.8e5);
}

TEST(RateLimitedLag, MovesAtItsRateAndThenAsALag) {
  const Value table = {
      {"type", "rate_limited_lag"}, {"tau_s", 0.05}, {"rate_per_s", 100.0}, {"start", std::vector<Value>{Value(10.0)}}};
  const std::unique_ptr<Component> stage = Build("actuator", table);
  std::vector<double> state(1), rate(1);
  const double in[] = {50.0};
  stage->Start(in, state, {});
  EXPECT_EQ(state[0], 10.0);
  stage->Derivative({0.0, in, state, {}}, rate);
  EXPECT_EQ(rate[0], 100.0);
  state[0] = 48.0;
  stage->Derivative({0.0, in, state, {}}, rate);
  EXPECT_NEAR(rate[0], 40.0, 1e-12);
  state[0] = 70.0;
  stage->Derivative({0.0, in, state, {}}, rate);
  EXPECT_EQ(rate[0], -100.0);
}

TEST(ResistorLoad, ConductsMoreUntilItIsWarm) {
  Alone load({{"type", "resistor_load"}, {"cold_share", 0.1}, {"warming_s", 3.0}}, {1e4, 0.03, 100.0});
  EXPECT_NEAR(load.Outputs()[0], 3e6, 1e-6) << "warm at the start";
  load.inputs[1] = 0.04;
  for (int n = 0; n <= 300; ++n) {
    EXPECT_NEAR(load.Outputs()[0], 1e8 * (0.04 + 0.1 * 0.01 * std::exp(-0.01 * n / 3.0)), 1e-4) << n;
    load.Step(0.01);
  }
}

}  // namespace
}  // namespace dynoproof
