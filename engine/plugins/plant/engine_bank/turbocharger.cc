#include "plugins/plant/engine_bank/turbocharger.h"

#include <cmath>
#include <numbers>

namespace dynoproof::mechanics {

Compressor::Point Compressor::At(double speed, const GasState& in, double pressure_out) const {
  const double u = radius * speed, head_at_most = head_max * u * u;
  const double head = in.cp * in.theta * (std::pow(pressure_out / in.pressure, (in.chi - 1.0) / in.chi) - 1.0);
  if (head >= head_at_most) return {0.0, 0.0};
  const double load = head > 0.0 ? head / head_at_most : 0.0, square = load * load;
  const double density = in.pressure / (in.R * in.theta);
  const double flow = density * std::numbers::pi * radius * radius * u * flow_max * (1.0 - square * square);
  return {flow, head > 0.0 ? flow * head / efficiency : 0.0 * head};  // a head that is no number stays none
}

Turbine::Point Turbine::At(const LaminarFlowFunction& psi, const GasState& in, const GasState& out) const {
  const double flow = ThrottleFlow(psi, area, in, out);
  if (!(flow > 0.0)) return {flow, 0.0};
  const double drop = 1.0 - std::pow(out.pressure / in.pressure, (in.chi - 1.0) / in.chi);
  return {flow, efficiency * flow * in.cp * in.theta * drop};
}

Cooled Cool(const GasState& in, const Compressor::Point& point, double effectiveness, double coolant) {
  if (!(point.flow > 0.0)) return {in.theta, 0.0};
  const double hot = in.theta + point.power / (point.flow * in.cp);
  const double theta = hot - effectiveness * (hot - coolant);
  return {theta, point.flow * in.cp * (hot - theta)};
}

double RotorSpeed(double energy, double inertia) { return std::sqrt(2.0 * (energy < 0.0 ? 0.0 : energy) / inertia); }

}  // namespace dynoproof::mechanics
