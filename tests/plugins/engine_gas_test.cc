// Gas exchange, turbochargers and the fired cycle: values by hand, closed forms, (6.1) itself, limits, both directions.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "plugins/physics/gas_exchange.h"
#include "plugins/physics/slider_crank.h"
#include "plugins/plant/engine_bank/turbocharger.h"
#include "plugins/plant/fired_cylinder/fired_cycle.h"

namespace dynoproof::mechanics {
namespace {

constexpr double kPi = std::numbers::pi;
const GasPair kGases;
const LaminarFlowFunction kPsi(0.01);

TEST(LaminarFlowFunction, MeetsTheFlowFunctionWithItsSlope) {
  for (const double delta : {1e-4, 0.01, 0.3}) {
    const LaminarFlowFunction psi(delta);
    const double ratio = 1.0 + delta, h = 1e-5 * delta;
    EXPECT_NEAR(psi(ratio - 1e-12), FlowFunction(ratio), 1e-9);
    EXPECT_EQ(psi(1.0 + 2.0 * delta), FlowFunction(1.0 + 2.0 * delta));
    const double below = (psi(ratio) - psi(ratio - h)) / h, above = (psi(ratio + h) - psi(ratio)) / h;
    EXPECT_NEAR(below / above, 1.0, 1e-4);  // differences of h = 1e-5 delta: curvature times h
    EXPECT_EQ(psi(1.0), 0.0);
    EXPECT_LT(psi(1.0 + h) / h, 2.0 * FlowFunction(ratio) / delta) << "finite slope";
  }
}

TEST(GasState, IsThatOfTheMixture) {
  const Charge charge = {{0.03, 0.01}, 2e4};
  const GasState gas = StateOf(kGases, charge, 0.02);
  const double mcv = 0.03 * 287.05 / 0.39 + 0.01 * 290.0 / 0.33, mR = 0.03 * 287.05 + 0.01 * 290.0;
  EXPECT_NEAR(gas.theta, 2e4 / mcv, 1e-10);
  EXPECT_NEAR(gas.pressure, mR * gas.theta / 0.02, 1e-7);
  EXPECT_NEAR(gas.chi, 1.0 + mR / mcv, 1e-14);
  EXPECT_NEAR(gas.cp - gas.R, mcv / 0.04, 1e-10);
  EXPECT_NEAR(gas.portion[1], 0.25, 1e-15);
  const Charge again = ChargeOf(gas, 0.02);
  EXPECT_NEAR(again.mass[0], 0.03, 1e-15);
  EXPECT_NEAR(again.energy, 2e4, 1e-9);
  const GasState same = StateAt(kGases, gas.pressure, gas.theta, 0.25);
  EXPECT_NEAR(same.chi, gas.chi, 1e-14);
  EXPECT_NEAR(same.R, gas.R, 1e-12);
}

TEST(GasState, ChangesItsPressureAsSixOneSays) {
  // d/dt p of the states' rates, by a central difference, against (6.1) term by term, as it is printed.
  const Charge charge = {{0.05, 0.02}, 2.4e4};
  const double volume = 0.012, dV = 0.3, Q_w = -4e3, h_in = 3.1e5, h_out = 8e5, q_in = 0.8, q_out = 0.5;
  const double dm[2] = {0.8 - 0.2, -0.3};  // in: air; out: both
  const GasState gas = StateOf(kGases, charge, volume);
  const double dU = h_in * q_in - h_out * q_out + Q_w - gas.pressure * dV;
  const auto pressure = [&](double t) {
    return StateOf(kGases, {{charge.mass[0] + t * dm[0], charge.mass[1] + t * dm[1]}, charge.energy + t * dU},
                   volume + t * dV)
        .pressure;
  };
  const double h = 1e-7, rate = (pressure(h) - pressure(-h)) / (2.0 * h);
  double sum_R = 0.0, sum_cv = 0.0;
  for (int j = 0; j < 2; ++j) {
    sum_R += kGases.R[j] * dm[j];
    sum_cv += kGases.R[j] / (kGases.chi[j] - 1.0) * dm[j];
  }
  const double printed = (gas.chi - 1.0) / volume *
                         (gas.theta / (gas.chi - 1.0) * sum_R - gas.theta * sum_cv -
                          gas.chi / (gas.chi - 1.0) * gas.pressure * dV + Q_w + q_in * h_in - q_out * h_out);
  EXPECT_NEAR(rate / printed, 1.0, 1e-8);  // central difference: 1e-16 / 1e-7 of the pressure, 1e-9 of the rate
}

TEST(Throttle, CarriesTheGasOfTheSideItComesFrom) {
  const GasState air = StateAt(kGases, 3e5, 350.0), burnt = StateAt(kGases, 2.5e5, 900.0, 1.0);
  const Charge forward = Throttle(kPsi, 1e-3, air, burnt), back = Throttle(kPsi, 1e-3, burnt, air);
  EXPECT_GT(forward.mass[0], 0.0);
  EXPECT_EQ(forward.mass[1], 0.0);
  EXPECT_NEAR(forward.energy, forward.mass[0] * kGases.cp(0) * 350.0, 1e-6);
  EXPECT_EQ(back.mass[0], -forward.mass[0]) << "the same flow, told from the other side";
  EXPECT_EQ(back.energy, -forward.energy);
  const Charge none = Throttle(kPsi, 1e-3, air, StateAt(kGases, 3e5, 900.0, 1.0));
  EXPECT_EQ(none.total(), 0.0);
  EXPECT_EQ(none.energy, 0.0);
  EXPECT_EQ(Throttle(kPsi, 0.0, air, burnt).total(), 0.0);
  // Choked by (6.5): A p/sqrt(2 R theta), whatever is behind.
  const double choked = 1e-3 * 3e5 / std::sqrt(2.0 * 287.05 * 350.0);
  EXPECT_NEAR(ThrottleFlow(kPsi, 1e-3, air, StateAt(kGases, 1.4e5, 300.0)), choked, 1e-12);
  EXPECT_NEAR(ThrottleFlow(kPsi, 1e-3, air, StateAt(kGases, 10.0, 300.0)), choked, 1e-12);
  EXPECT_TRUE(std::isnan(ThrottleFlow(kPsi, 1e-3, air, StateAt(kGases, std::nan(""), 300.0))));
}

TEST(ValveTrain, OpensWhereItSays) {
  const ValveTrain valve{WithinCycle(-0.4), 4.0, 2e-3};
  EXPECT_NEAR(valve.closes(), 3.6, 1e-12);
  EXPECT_EQ(valve.Area(WithinCycle(-0.41)), 0.0);
  EXPECT_NEAR(valve.Area(1.6), 2e-3, 1e-15);
  EXPECT_NEAR(valve.Area(0.0), 2e-3 * std::pow(std::sin(kPi * 0.1), 2), 1e-15);
  EXPECT_EQ(valve.Area(3.61), 0.0);
  EXPECT_EQ(valve.Area(10.0), 0.0);
  EXPECT_EQ(WithinCycle(-1.0), 4.0 * kPi - 1.0);
  EXPECT_LT(WithinCycle(4.0 * kPi), 1e-12);
}

TEST(WallHeat, IsHohenbergs) {
  for (const auto& [volume, pressure, theta, speed] :
       {std::tuple(0.0024, 150e5, 1900.0, 11.7), std::tuple(0.028, 0.3e5, 280.0, 0.0)}) {
    const double plain = 130.0 * std::pow(volume, -0.06) * std::pow(pressure * 1e-5, 0.8) * std::pow(theta, -0.4) *
                         std::pow(speed + 1.4, 0.8);
    EXPECT_NEAR(WallHeatCoefficient(volume, pressure, theta, WallHeatSpeedFactor(speed)) / plain, 1.0, 1e-13);
  }
}

TEST(SliderCrank, HasTheDerivativesOfItsTravel) {
  const SliderCrank crank{0.175, 0.75};
  EXPECT_NEAR(crank.At(kPi).s, 0.35, 1e-15);
  for (const double phi : {0.0, 0.3, 1.9, 3.5, 6.0}) {
    const double h = 1e-5;
    EXPECT_NEAR((crank.At(phi + h).s - crank.At(phi - h).s) / (2.0 * h), crank.At(phi).first, 1e-10);
    EXPECT_NEAR((crank.At(phi + h).first - crank.At(phi - h).first) / (2.0 * h), crank.At(phi).second, 1e-10);
  }
}

TEST(Compressor, FollowsItsLine) {
  const Compressor compressor{0.25, 0.14, 0.7, 0.8};
  const GasState in = StateAt(kGases, 1e5, 300.0);
  const double u = 0.25 * 1200.0, density = 1e5 / (287.05 * 300.0), area = kPi * 0.0625;
  // Half of the largest head: phi = phi_max (1 - 1/16).
  const double head = 0.35 * u * u, exponent = 1.39 / 0.39, cp = kGases.cp(0);
  const Compressor::Point half = compressor.At(1200.0, in, 1e5 * std::pow(1.0 + head / (cp * 300.0), exponent));
  EXPECT_NEAR(half.flow, density * area * u * 0.14 * 15.0 / 16.0, 1e-10);
  EXPECT_NEAR(half.power, half.flow * head / 0.8, 1e-6);
  EXPECT_EQ(compressor.At(1200.0, in, 9e5).flow, 0.0) << "beyond its head: closed";
  const Compressor::Point choked = compressor.At(1200.0, in, 0.5e5);
  EXPECT_NEAR(choked.flow, density * area * u * 0.14, 1e-12);
  EXPECT_EQ(choked.power, 0.0);
  EXPECT_EQ(compressor.At(0.0, in, 1e5).flow, 0.0) << "at rest";
  EXPECT_EQ(compressor.At(0.0, in, 0.5e5).flow, 0.0);
  EXPECT_TRUE(std::isnan(compressor.At(1200.0, in, std::nan("")).power));
}

TEST(Turbine, TakesItsShareOfTheIsentropicDrop) {
  const Turbine turbine{0.02, 0.75};
  const GasState in = StateAt(kGases, 3e5, 850.0, 1.0), out = StateAt(kGases, 1.2e5, 700.0, 1.0);
  const Turbine::Point point = turbine.At(kPsi, in, out);
  EXPECT_NEAR(point.flow, 0.02 * 3e5 / std::sqrt(2.0 * 290.0 * 850.0), 1e-10);
  const double cooler = 850.0 * std::pow(1.2 / 3.0, 0.33 / 1.33);
  EXPECT_NEAR(point.power, 0.75 * point.flow * kGases.cp(1) * (850.0 - cooler), 1e-6);
  const Turbine::Point back = turbine.At(kPsi, out, in);
  EXPECT_LT(back.flow, 0.0);
  EXPECT_EQ(back.power, 0.0);
  EXPECT_EQ(turbine.At(kPsi, in, in).power, 0.0);
}

TEST(Turbocharger, RunsSteadyWherePowersAreEqual) {
  // Kinetic energy integrated to its rest, against bisection of the balance over the speed.
  const Compressor compressor{0.18, 0.14, 0.7, 0.8};
  const Turbine turbine{0.01, 0.8};
  const GasState in = StateAt(kGases, 1e5, 300.0), hot = StateAt(kGases, 2.2e5, 850.0, 1.0);
  const GasState out = StateAt(kGases, 1e5, 700.0, 1.0);
  const double drive = 0.97 * turbine.At(kPsi, hot, out).power;
  const auto surplus = [&](double speed) { return drive - compressor.At(speed, in, 2e5).power; };
  double energy = 0.5 * 0.3 * 1500.0 * 1500.0;
  for (int i = 0; i < 200000; ++i) energy += 1e-3 * surplus(RotorSpeed(energy, 0.3));
  double low = 500.0, high = 6000.0;
  for (int i = 0; i < 80; ++i) (surplus(0.5 * (low + high)) > 0.0 ? low : high) = 0.5 * (low + high);
  EXPECT_GT(low, 1000.0);
  EXPECT_LT(high, 3000.0);
  EXPECT_NEAR(RotorSpeed(energy, 0.3), low, 1e-6);
  EXPECT_EQ(RotorSpeed(0.0, 0.3), 0.0);
  EXPECT_EQ(RotorSpeed(-1e-9, 0.3), 0.0);
  EXPECT_TRUE(std::isnan(RotorSpeed(std::nan(""), 0.3)));
}

TEST(Cooler, TakesTheHeatThatTheGasLoses) {
  const GasState in = StateAt(kGases, 1e5, 300.0);
  const Cooled cooled = Cool(in, {2.0, 2e5}, 0.9, 315.0);
  const double hot = 300.0 + 1e5 / in.cp;
  EXPECT_NEAR(cooled.theta, hot - 0.9 * (hot - 315.0), 1e-10);
  EXPECT_NEAR(cooled.heat, 2.0 * in.cp * (hot - cooled.theta), 1e-6);
  EXPECT_EQ(Cool(in, {0.0, 0.0}, 0.9, 315.0).heat, 0.0);
}

TEST(FiredCycle, KeepsTheFirstLaw) {
  const FiredCycle cycle{1.37, 1.33, 47e6, 0.15};
  const double v_1 = 0.026, v_2 = 0.0026, v_4 = 0.024;
  const FiredCycle::Result result = cycle.Run(2e5, 330.0, v_1, v_2, v_4, 1.5e-3);
  const double u_1 = 2e5 * v_1 / 0.37, u_4 = result.pressure_end * v_4 / 0.33;
  EXPECT_NEAR(result.heat, 0.85 * 1.5e-3 * 47e6, 1e-9);
  EXPECT_NEAR(result.work, u_1 + result.heat - u_4, 1e-9);
  // The same work as the integral of p dV, Simpson over both isentropes.
  const auto work = [](double p, double v, double to, double chi) {
    const int n = 20000;
    double sum = 0.0;
    for (int i = 0; i < n; ++i) {
      const double a = v + (to - v) * i / n, b = v + (to - v) * (i + 1) / n;
      const auto at = [&](double x) { return p * std::pow(v / x, chi); };
      sum += (b - a) / 6.0 * (at(a) + 4.0 * at(0.5 * (a + b)) + at(b));
    }
    return sum;
  };
  EXPECT_NEAR(work(2e5, v_1, v_2, 1.37) + work(result.pressure_fired, v_2, v_4, 1.33), result.work, 1e-9 * result.heat);
}

TEST(FiredCycle, WithoutFuelIsASpring) {
  const FiredCycle cycle{1.35, 1.35, 47e6, 0.15};
  const FiredCycle::Result result = cycle.Run(2e5, 330.0, 0.026, 0.0025, 0.024, 0.0);
  EXPECT_NEAR(result.pressure_end, 2e5 * std::pow(0.026 / 0.024, 1.35), 1e-6);
  EXPECT_NEAR(cycle.Run(2e5, 330.0, 0.026, 0.0025, 0.026, 0.0).work, 0.0, 1e-9);
}

TEST(FiredCycle, LaterHeatGivesLessWorkAndHotterExhaust) {
  const FiredCycle cycle{1.37, 1.33, 47e6, 0.15};
  const FiredCycle::Result early = cycle.Run(2e5, 330.0, 0.026, 0.0025, 0.024, 1.5e-3);
  const FiredCycle::Result late = cycle.Run(2e5, 330.0, 0.026, 0.0030, 0.024, 1.5e-3);
  EXPECT_LT(late.work, early.work);
  EXPECT_GT(late.pressure_end, early.pressure_end);
  EXPECT_LT(late.theta_unburnt, early.theta_unburnt);
}

}  // namespace
}  // namespace dynoproof::mechanics
