// The simplified speed loop of thesis Sec. 2 (Fig. 2.3): a two-mass oscillator, a PI speed controller with shaft-torque
// feedthrough, a first-order actuator; and Hurwitz' criterion for any polynomial.
#pragma once

#include <Eigen/Dense>
#include <complex>

#include "base/status.h"
#include "thesis/two_mass.h"

namespace dynoproof::mechanics {

/// The controller (2.3) and the actuator (2.4).
struct SpeedLoop {
  TwoMass plant;
  double k_P;    // [N m s/rad]
  double k_I;    // [N m/rad]
  double k_V;    // feedthrough of T_shaft [-]. (2.3) adds k_V T_shaft with T_shaft = k (phi_1 - phi_2); the control of
                 // chapter 5 amplifies the torque of the device under test: there this number is negative
  double tau_a;  // [s], >= 0
};

/// The plant (2.2): T_shaft/T_airgap and omega_1/T_airgap at s. The print of P_2 has the numerator s + (c s + k)/I2 and
/// lacks an s in the denominator; right is (s^2 + (c s + k)/I2) / (I1 s (s^2 + ...)), with which (2.5) follows.
std::complex<double> ShaftTorqueTransfer(const TwoMass& plant, std::complex<double> s);  // P_1 [-]
std::complex<double> SpeedTransfer(const TwoMass& plant, std::complex<double> s);        // P_2 [rad/(s N m)]

/// G_omega of (2.5), coefficients by falling powers: 4 of the numerator, 6 of the denominator (the first is I1 tau_a, 0
/// for an ideal actuator).
struct ClosedLoop {
  Eigen::VectorXd numerator, denominator;
};
ClosedLoop CloseLoop(const SpeedLoop& loop);
/// G_omega at s from the blocks: P_2 A C / (1 - k_V A P_1 + A C P_2), A = 1/(s tau_a + 1), C = k_P + k_I/s.
std::complex<double> ClosedLoopTransfer(const SpeedLoop& loop, std::complex<double> s);

/// (2.6): k_V must stay below I1 (1/I1 + 1/I2) + k_P c/(k I2) + k_I/k. Necessary: the coefficient of s^2.
double FeedthroughBound(const SpeedLoop& loop);
/// The same from the coefficient of s^3, for c > 0 (infinity without damping): k_V < I1 (1/I1 + 1/I2) (1 + k tau_a/c) +
/// k_P/c.
double FeedthroughBoundFromDamping(const SpeedLoop& loop);

/// Horner's rule; coefficients by falling powers.
std::complex<double> Evaluate(const Eigen::VectorXd& coefficients, std::complex<double> s);

/// All roots, as eigenvalues of the balanced companion matrix. Leading zeros are dropped. Fails (exit code 2) on a
/// polynomial that is zero, constant or not finite.
Result<Eigen::VectorXcd> PolynomialRoots(const Eigen::VectorXd& coefficients);

/// Hurwitz' determinants D_1 ... D_n of the monic polynomial with s in units of the geometric mean of its roots (which
/// changes no sign): the roots lie left of the axis exactly when all are positive. Empty where the trailing coefficient
/// is zero or the polynomial is of degree 0.
Eigen::VectorXd HurwitzDeterminants(const Eigen::VectorXd& coefficients);

/// Whether all roots have a negative real part, by Routh's array. Roots on the axis, non-finite and zero polynomials
/// are not stable; a constant other than 0 is (it has no roots).
bool IsHurwitz(const Eigen::VectorXd& coefficients);

}  // namespace dynoproof::mechanics
