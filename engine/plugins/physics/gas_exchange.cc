#include "plugins/physics/gas_exchange.h"

#include <cmath>

namespace dynoproof::mechanics {

GasState StateAt(const GasPair& gases, double pressure, double theta, double exhaust_portion) {
  const double air = 1.0 - exhaust_portion, R = air * gases.R[0] + exhaust_portion * gases.R[1];
  const double cp = air * gases.cp(0) + exhaust_portion * gases.cp(1);
  return {pressure, theta, R, cp, cp / (cp - R), {air, exhaust_portion}};
}

Charge ChargeOf(const GasState& state, double volume) {
  const double mass = state.pressure * volume / (state.R * state.theta);
  return {{mass * state.portion[0], mass * state.portion[1]}, mass * (state.cp - state.R) * state.theta};
}

Charge Carry(const GasState& gas, double flow) {
  return {{flow * gas.portion[0], flow * gas.portion[1]}, flow * gas.cp * gas.theta};
}

double ThrottleFlow(const LaminarFlowFunction& psi, double area, const GasState& a, const GasState& b) {
  const bool back = b.pressure > a.pressure;
  const GasState& up = back ? b : a;
  const double down = back ? a.pressure : b.pressure;
  const double flow = area * up.pressure / std::sqrt(up.R * up.theta) * psi(up.pressure / down);
  return back ? -flow : flow;
}

Charge Throttle(const LaminarFlowFunction& psi, double area, const GasState& a, const GasState& b) {
  const double flow = ThrottleFlow(psi, area, a, b);
  return Carry(flow < 0.0 ? b : a, flow);
}

double WallHeatSpeedFactor(double mean_piston_speed) { return std::pow(mean_piston_speed + 1.4, 0.8); }

double WallHeatCoefficient(double volume, double pressure, double theta, double speed_factor) {
  // p^0.8 V^-0.06 theta^-0.4 = ((p^2/theta)^20 / V^3)^0.02: one logarithm. 1e-122 to 1e60 for what an engine can hold.
  const double p = 1e-5 * pressure, x = p * p / theta, x2 = x * x, x4 = x2 * x2, x16 = x4 * x4 * x4 * x4;
  return 130.0 * speed_factor * std::exp(0.02 * std::log(x16 * x4 / (volume * volume * volume)));
}

}  // namespace dynoproof::mechanics
