// Equations of linear systems in discrete time, x+ = A x + w, y = C x + v, solved by doubling: each step covers twice the
// time of the one before, so that a memory of ten thousand periods takes fourteen.
#pragma once

#include <Eigen/Dense>

namespace dynoproof::mechanics {

/// The stationary covariance X = A X A' + Q [n x n] of x+ = A x + w, cov w = Q. Of an A that is not stable the entries are
/// not finite, or huge.
Eigen::MatrixXd StationaryCovariance(const Eigen::MatrixXd& A, const Eigen::MatrixXd& Q);

/// The stationary Kalman filter for cov w = Q [n x n] and cov v = diag(R) [m].
struct StationaryFilter {
  Eigen::MatrixXd gain;        // K [n x m]: x += K (y - C x)
  Eigen::MatrixXd covariance;  // P [n x n] of x before the sample
};
/// Structure-preserving doubling (Chu, Fan, Lin, Wang 2004, discrete algebraic Riccati equation).
StationaryFilter MakeStationaryFilter(const Eigen::MatrixXd& A, const Eigen::MatrixXd& C, const Eigen::MatrixXd& Q,
                                      const Eigen::VectorXd& R);

/// The part of x+ = A x + B w, y = C x that w moves and y sees: x = basis z, z = reduction x, reduction basis = 1.
struct BalancedPart {
  Eigen::MatrixXd basis, reduction;  // n x r, r x n
  Eigen::VectorXd seen;              // n: how much y sees of each state, over the most that it sees of one; 0: never
};
/// Balanced truncation by square roots (Moore 1981; Antoulas, Approximation of Large-Scale Dynamical Systems, 2005, 7.1)
/// to at most `most` states. Both Gramians forget by `leak` a period (below 1), so that free integrators have one; what
/// is seen or moved by less than 1e-6 of the largest amplitude counts as not seen. Where an integrator hides in rounding what
/// else is moved, sizes down to 1e-5 of the largest are taken from the product of both Gramians.
BalancedPart Balance(const Eigen::MatrixXd& A, const Eigen::MatrixXd& B, const Eigen::MatrixXd& C, double leak,
                     int most);

/// Observability Gramian of a system that forgets by `leak` a period, sum_k leak^2k A'^k C'C A^k [n x n].
Eigen::MatrixXd Observability(const Eigen::MatrixXd& A, const Eigen::MatrixXd& C, double leak);
/// Orthonormal basis [n x s] of what a Gramian has more of than 1e-6 of the largest amplitude.
Eigen::MatrixXd RangeOf(const Eigen::MatrixXd& gramian);

}  // namespace dynoproof::mechanics
