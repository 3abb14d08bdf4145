// The pressure loops of chapter 6: bounds and characteristic polynomials.
// Polynomials hold the coefficients of s^n first, those of s^0 last.
#pragma once

#include <Eigen/Dense>

#include "plugins/control/pressure_pi/pressure_gains.h"

namespace dynoproof::mechanics {

struct TransferPolynomials {
  Eigen::VectorXd numerator, denominator;
};
/// (6.20): p over p* with the controller around C dp/dt = w - outflow p; `outflow` [kg/(s Pa)] is what an engine takes
/// in proportion to the pressure, 0 in print.
TransferPolynomials VolumeLoop(double capacity_kg_per_Pa, const PiGains& gains, double outflow_kg_per_s_Pa = 0.0);

/// The membrane regulator (6.29).
struct Regulator {
  double m, k_s, c_s, A;      // mass [kg], stiffness [N/m], damping [N s/m], membrane area [m^2]
  double k_q, pressure_rate;  // flow per travel [kg/(s m)], R theta/V [Pa/kg]
};
/// Characteristic polynomial of (6.30), and of (6.34) with gains in [-], [1/s].
Eigen::VectorXd RegulatorPolynomial(const Regulator& regulator);
TransferPolynomials RegulatorLoop(const Regulator& regulator, const PiGains& gains);
/// (6.31): the stiffness below which the regulator alone is unstable.
double LeastStiffness(const Regulator& regulator);
/// (6.37): the gains above which the loop is unstable.
double LargestProportionalGain(const Regulator& regulator);
double LargestIntegralGain(const Regulator& regulator, double k_P);

/// Largest real part of a polynomial's roots: negative where the loop is stable. NaN for a polynomial without roots.
double LargestRealPart(const Eigen::VectorXd& polynomial);

}  // namespace dynoproof::mechanics
