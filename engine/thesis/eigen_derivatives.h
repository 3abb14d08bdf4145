// Eigenvectors of the reduced stiffness matrix and what inertias and stiffnesses do to eigenfrequencies (thesis
// Sec. 2.2.4, 2.2.5), for chains as the thesis has it and for any network.
#pragma once

#include <Eigen/Dense>
#include <vector>

#include "linear/modes.h"
#include "linear/network.h"
#include "thesis/descriptions.h"

namespace dynoproof::mechanics {

/// Diagonal of L (2.37): 1, k_2/k_1, ..., k_n/k_1. L K_Delta L^-1 = K_Delta^T (2.39). R of (2.38) is its inverse.
Eigen::VectorXd LeftScaling(const Chain& chain);

/// Right eigenvectors of K_Delta and what follows from them.
struct ReducedModes {
  Eigen::VectorXd lambda;  // n eigenvalues [rad^2/s^2], all negative: -nu^2, by rising nu
  Eigen::MatrixXd right;   // n x n, columns V_r (2.45)
  Eigen::VectorXd gamma;   // n, diagonal of V_r^T L V_r (2.48), positive

  Eigen::MatrixXd Left(const Chain& chain) const;     // columns L r_i (2.44), (2.46)
  Eigen::MatrixXd Inverse(const Chain& chain) const;  // V_r^-1 = Gamma^-1 V_r^T L (2.49)
};

/// Through the symmetric matrix L^1/2 K_Delta L^-1/2, so that eigenvalues come out real; columns have length one.
ReducedModes SolveReduced(const Chain& chain);

/// d lambda / d I_(n+1) of the last inertia by (2.59) [rad^2/s^2 per kg m^2]: k_n^2 / (k_1 I^2) r_(i,n)^2 / gamma_i.
/// All positive: a larger last inertia lowers every eigenfrequency.
Eigen::VectorXd LastInertiaDerivative(const Chain& chain, const ReducedModes& modes);

/// Derivatives of nu^2 [rad^2/s^2] of every undamped mode, from mass-normalised shapes:
///   d nu^2 / d I_i = -nu^2 phi_i^2,   d nu^2 / d k_e = (phi_from - phi_to)^2.
/// Equal frequencies (relative distance of nu below `equal`) have no single derivative by mode, as any mixture of their
/// shapes is a shape. One parameter changes just one of them: then the sum over the shapes goes to the mode that leads
/// when the parameter grows (the lowest for an inertia, the highest for a stiffness), the others get 0. These are
/// one-sided derivatives for a growing parameter with the frequencies kept in rising order.
struct FrequencyDerivatives {
  Eigen::MatrixXd by_inertia;    // modes x nodes, [rad^2/s^2 per kg m^2], <= 0
  Eigen::MatrixXd by_stiffness;  // modes x edges, [rad^2/s^2 per N m/rad], >= 0
};
FrequencyDerivatives DifferentiateFrequencies(const Network& network, const ModalAnalysis& modal, double equal = 1e-9);

}  // namespace dynoproof::mechanics
