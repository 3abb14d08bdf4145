// The pressure loops of chapter 6: gains, references, bounds and characteristic polynomials.
// Polynomials hold the coefficients of s^n first, those of s^0 last.
#pragma once

#include <Eigen/Dense>

namespace dynoproof::mechanics {

/// A PI controller with feed-forward: w = k_P (r - y) + k_F r + integral of k_I (r - y).
struct PiGains {
  double k_P, k_I, k_F;
};

/// (6.21): a volume of capacity C = V/(R theta) [kg/Pa] under mass flow follows r as a first-order lag v_n/(s + v_n).
PiGains FirstOrderLagGains(double capacity_kg_per_Pa, double v_n_rad_per_s);

struct TransferPolynomials {
  Eigen::VectorXd numerator, denominator;
};
/// (6.20): p over p* with the controller around C dp/dt = w - outflow p; `outflow` [kg/(s Pa)] is what an engine takes
/// in proportion to the pressure, 0 in print.
TransferPolynomials VolumeLoop(double capacity_kg_per_Pa, const PiGains& gains, double outflow_kg_per_s_Pa = 0.0);

/// (6.13): p_s / p_ch - 1 at which a flap of that area lets pass what the engine pumps [-]. `swept` = lambda V_d omega
/// / (2 pi N_r) [m^3/s].
double PressureSurplus(double swept_m3_per_s, double area_m2, double R_theta);

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
