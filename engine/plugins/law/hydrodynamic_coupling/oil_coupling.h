// A hydrodynamic coupling as thesis chapter 4 models it: a spring beside oil that is squeezed through gaps.
//
//   dDp/dt = -kappa_p Dp + kappa_w w      (4.19)      T = k_s d + k_p Dp      (4.20)
//
// d [rad]: twist, w its rate, Dp [Pa]: pressure drop between the two chambers of a segment. Of k_p and kappa_w only the
// product K = k_p kappa_w [N m/rad] shows outside: K is the stiffness that the closed-in oil adds to the spring's.
// Reciprocity: with the lever arm of (4.18) the power N Dp dV/dt that the oil takes up is the power T_H w of (4.3); so
// k_p Dp^2 / (2 kappa_w) is the energy stored in the oil and k_p kappa_p / kappa_w Dp^2 what its friction turns to
// heat.
#pragma once

#include <Eigen/Dense>
#include <string>
#include <vector>

#include "base/status.h"

namespace dynoproof::mechanics {

/// Stiffness [N m/rad] and damping [N m s/rad] that a coupling shows under a steady sine, (4.1).
struct DynamicValues {
  double stiffness, damping;
};

struct OilCoupling {
  double k_s;      // [N m/rad] spring
  double k_p;      // [m^3] torque per pressure drop, (4.4)
  double kappa_p;  // [1/s] decay of the pressure drop
  double kappa_w;  // [Pa/rad] pressure drop per twist of closed-in oil

  double oil_stiffness() const { return k_p * kappa_w; }
  /// k(nu) and c(nu) of (4.21); nu in rad/s.
  DynamicValues At(double nu_rad_per_s) const;
};

/// A segment of the coupling, Fig. 4.7, and its oil.
struct OilCouplingGeometry {
  int segments;                // N, each a pair of chambers
  double width;                // w [m], along the axis
  double length;               // l [m], along the radius
  double inner_radius;         // r [m]
  double chamber_volume;       // V_0 [m^3]
  double gap_height;           // D [m], underneath the intermediate piece
  double gap_length;           // L [m], in the direction of the flow
  double bulk_modulus;         // beta [Pa], as it acts: dissolved air and soft walls lower it
  double density;              // rho_0 [kg/m^3]
  double kinematic_viscosity;  // sigma [m^2/s]
  double spring;               // k_s [N m/rad]

  double side_area() const { return width * length; }           // A, (4.16)
  double lever() const { return inner_radius + 0.5 * length; }  // r + l/2, (4.18)
};

/// The chain (4.3)-(4.19). k_p = N w (l^2/2 + l r): the integral of the lever arm r + y over y = 0 ... l; the printed
/// 2 l r would make energy, see above. kappa_HP = w D^3 / (12 rho sigma L) (1 - 0.63 D/w): Hagen-Poiseuille between
/// flat walls, with the first-order share of the two ends of the gap.
OilCoupling FromGeometry(const OilCouplingGeometry& geometry);

/// How far an operating point is from what the chain assumes.
struct OilCouplingValidity {
  double travel;    // A dx / V_0 at the largest twist; (4.17) errs by its square
  double reynolds;  // v D_H / sigma, if all displaced oil passes the gap at the largest rate: an upper bound
  double pressure;  // Dp [Pa] at a lasting largest rate
  double density;   // Dp / beta, taken as small in (4.11)
  /// A sentence per assumption that does not hold: A dx > V_0 / 10, Re > 2000 (laminar, printed bound: 400),
  /// Dp > beta / 100.
  std::vector<std::string> warnings;
};
OilCouplingValidity CheckValidity(const OilCouplingGeometry& geometry, double largest_twist_rad,
                                  double largest_rate_rad_per_s);

/// A data sheet: what the maker says of k and c at frequencies nu. NaN marks a value that it does not give.
struct CouplingTable {
  std::vector<double> nu;                  // rising [rad/s]
  std::vector<double> stiffness, damping;  // [N m/rad], [N m s/rad]
};
/// Faults of a table: lengths, order, negative values, nothing to read. Empty when it is good.
std::string FaultOf(const CouplingTable& table);
/// k and c at a frequency, straight between the rows that have them; beyond the ends the last value there. NaN where
/// the table gives none at all.
DynamicValues At(const CouplingTable& table, double nu_rad_per_s);

/// The oil model closest to a table: least squares of the relative deviations of all its values.
struct OilCouplingFit {
  double k_s, oil_stiffness, kappa_p;  // K = k_p kappa_w
  double interval[3];                  // half width of the 95 % interval of each, if the deviations are random
  std::vector<double> stiffness_residual, damping_residual;  // model / table - 1 by row, NaN where none is given
  double rms;                                                // of all of them
  int iterations;
};
/// Levenberg-Marquardt in the logarithms of the three, from the best of 40 kappa_p (with kappa_p given the other two
/// follow from linear equations). Fails (exit code 2) on a faulty table or one with fewer than 4 values.
Result<OilCouplingFit> FitOilCoupling(const CouplingTable& table);

}  // namespace dynoproof::mechanics
