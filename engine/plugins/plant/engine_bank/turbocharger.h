// Compressor, turbine and shaft of a turbocharger by its power balance, thesis Sec. 6.1.3. The thesis prints no maps:
// the compressor has dimensionless lines that fit most radial machines, the turbine is a nozzle.
#pragma once

#include "plugins/physics/gas_exchange.h"

namespace dynoproof::mechanics {

/// Radial compressor: head coefficient psi = dh_s/u^2 against flow coefficient phi = q/(rho pi r^2 u), u = r omega:
///   phi = phi_max (1 - (psi/psi_max)^4), psi in 0 ... psi_max; choked at phi_max below, a closed check valve above.
/// dh_s = c_p theta_in (Pi^((chi-1)/chi) - 1); the power is q dh_s/eta.
struct Compressor {
  double radius = 0.0, flow_max = 0.0, head_max = 0.0, efficiency = 1.0;  // r [m], phi_max, psi_max, eta
  struct Point {
    double flow, power;  // [kg/s] >= 0, [W] >= 0 into the gas
  };
  /// At a speed [rad/s] >= 0. A rotor at rest lets nothing through.
  Point At(double speed, const GasState& in, double pressure_out) const;
};

/// Turbine as a nozzle of one effective area [m^2] by (6.4), with the power eta q c_p theta (1 - Pi^-((chi-1)/chi)).
/// What flows back gives no power.
struct Turbine {
  double area = 0.0, efficiency = 1.0;
  struct Point {
    double flow, power;  // [kg/s], negative backwards; [W] >= 0 out of the gas
  };
  Point At(const LaminarFlowFunction& psi, const GasState& in, const GasState& out) const;
};

/// The stream behind a cooler that takes effectiveness * (theta - coolant) from the gas; and the heat [W] it takes.
struct Cooled {
  double theta, heat;
};
/// Gas of `flow` [kg/s] that a compressor has given `power` [W]; without flow it has the temperature it came with.
Cooled Cool(const GasState& in, const Compressor::Point& point, double effectiveness, double coolant);

/// Speed [rad/s] from the kinetic energy [J] of a rotor; its power balance is linear in the energy.
double RotorSpeed(double energy, double inertia);

}  // namespace dynoproof::mechanics
