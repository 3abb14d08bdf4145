// Gas exchange of an engine, 0D: volumes that hold fresh air (0) and exhaust gas (1), flows between them, valves, wall
// heat. Thesis Sec. 6.1.3, (6.1).
//
// A volume's states are its masses m_j and its internal energy U, not its pressure: what one volume loses another gains
// to the last digit, and U' = sum h q + Q_w - p V' says the same as (6.1). With U = theta sum m_j c_v,j and
// p V = theta sum m_j R_j, c_v,j = R_j/(chi_j - 1), chi - 1 = sum m_j R_j / sum m_j c_v,j, the time derivative of
// p V = (chi - 1) U gives (6.1) term by term.
#pragma once

#include <array>
#include <cmath>
#include <numbers>
#include <span>

#include "plugins/physics/gas_flow.h"

namespace dynoproof::mechanics {

/// The two gases: specific gas constants [J/(kg K)] and heat capacity ratios, constant.
struct GasPair {
  std::array<double, 2> R = {287.05, 290.0}, chi = {1.39, 1.33};
  std::array<double, 2> cv = {R[0] / (chi[0] - 1.0), R[1] / (chi[1] - 1.0)};  // follow from them
  double cp(int j) const { return R[j] + cv[j]; }
};

/// What a volume holds [kg, kg, J]; also a flow of that [kg/s, kg/s, W].
struct Charge {
  std::array<double, 2> mass = {0.0, 0.0};
  double energy = 0.0;
  double total() const { return mass[0] + mass[1]; }
  Charge& operator+=(const Charge& other) {
    for (int j = 0; j < 2; ++j) mass[j] += other.mass[j];
    energy += other.energy;
    return *this;
  }
  Charge& operator-=(const Charge& other) {
    for (int j = 0; j < 2; ++j) mass[j] -= other.mass[j];
    energy -= other.energy;
    return *this;
  }
};

/// Where a plant keeps charges among its states: three each, one behind the other.
inline Charge ChargeAt(std::span<const double> states, int index) {
  return {{states[3 * index], states[3 * index + 1]}, states[3 * index + 2]};
}
inline void Put(const Charge& charge, int index, std::span<double> states) {
  states[3 * index] = charge.mass[0];
  states[3 * index + 1] = charge.mass[1];
  states[3 * index + 2] = charge.energy;
}

/// The gas of a volume as its neighbours see it.
struct GasState {
  double pressure, theta;         // [Pa], [K]
  double R, cp, chi;              // of the mixture
  std::array<double, 2> portion;  // of the mass, by gas
};
/// Of a charge in a volume [m^3]; masses and energy > 0.
inline GasState StateOf(const GasPair& gases, const Charge& charge, double volume) {
  const double mR = charge.mass[0] * gases.R[0] + charge.mass[1] * gases.R[1];
  const double mcv = charge.mass[0] * gases.cv[0] + charge.mass[1] * gases.cv[1];
  const double theta = charge.energy / mcv, per_mass = 1.0 / charge.total();
  return {mR * theta / volume,   theta,          mR * per_mass,
          (mR + mcv) * per_mass, 1.0 + mR / mcv, {charge.mass[0] * per_mass, charge.mass[1] * per_mass}};
}
/// At a pressure and temperature, with a portion of exhaust gas.
GasState StateAt(const GasPair& gases, double pressure, double theta, double exhaust_portion = 0.0);
/// The charge that has this state in a volume.
Charge ChargeOf(const GasState& state, double volume);

/// A mass flow [kg/s] of that gas with its enthalpy, as a flow of charge.
Charge Carry(const GasState& gas, double flow);
/// Mass flow through an area [m^2] by (6.4), from a to b; negative when it flows back. Pressures > 0.
double ThrottleFlow(const LaminarFlowFunction& psi, double area, const GasState& a, const GasState& b);
/// The same with what it carries: the gas of the side it comes from.
Charge Throttle(const LaminarFlowFunction& psi, double area, const GasState& a, const GasState& b);

inline constexpr double kCycle = 4.0 * std::numbers::pi;  // of four strokes [rad]
/// An angle [rad] within [0, 4 pi).
inline double WithinCycle(double phi) { return phi - kCycle * std::floor(phi / kCycle); }
/// Cycles that have begun by an angle, each at `begin` within it. A turn that cannot be counted changes nothing; the
/// run breaks by itself.
inline int CyclesBegun(double angle, double begin) {
  return std::abs(angle) < 1e9 ? static_cast<int>(std::floor((angle - begin) / kCycle)) : 0;
}

/// Effective area of all intake or exhaust valves of a cylinder over its crank angle [rad], 0 at the top dead centre
/// with gas exchange. The lift is that of a cam with continuous slope: lift_max sin^2; the area is the curtain under
/// the discs times the discharge coefficient.
struct ValveTrain {
  double opens = 0.0, duration = 1.0;  // [rad], within a cycle
  double largest_area = 0.0;           // count * discharge * pi * diameter * lift_max [m^2]
  double closes() const { return WithinCycle(opens + duration); }
  /// At an angle within [0, 4 pi).
  double Area(double phi) const {
    double open = phi - opens;
    if (open < 0.0) open += kCycle;
    if (open >= duration) return 0.0;
    const double root = std::sin(std::numbers::pi * open / duration);
    return largest_area * root * root;
  }
};

/// Heat transfer coefficient [W/(m^2 K)] of a combustion chamber after Hohenberg (1979):
/// 130 V^-0.06 p^0.8 theta^-0.4 (c_m + 1.4)^0.8, V in m^3, p in bar, theta in K, mean piston speed c_m in m/s.
/// `speed_factor` is (c_m + 1.4)^0.8, the same for all cylinders.
double WallHeatCoefficient(double volume, double pressure, double theta, double speed_factor);
double WallHeatSpeedFactor(double mean_piston_speed);

}  // namespace dynoproof::mechanics
