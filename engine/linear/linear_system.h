// The linear part of a plant in state space, with the integrators (rigid-body angles) kept apart: an angle that grows
// without bound must not spoil the twists that are computed beside it.
#pragma once

#include <Eigen/Dense>

namespace dynoproof::mechanics {

/// x' = A x + B u,  p' = P x,  y = C x + E p + D u.
/// x: n states, p: q integrators that nothing but y depends on, u: m inputs, y: r outputs. SI units.
struct LinearSystem {
  Eigen::MatrixXd A, B;     // n x n, n x m
  Eigen::MatrixXd P;        // q x n
  Eigen::MatrixXd C, E, D;  // r x n, r x q, r x m

  int states() const { return static_cast<int>(A.rows()); }
  int integrators() const { return static_cast<int>(P.rows()); }
  int inputs() const { return static_cast<int>(B.cols()); }
  int outputs() const { return static_cast<int>(C.rows()); }
};

}  // namespace dynoproof::mechanics
