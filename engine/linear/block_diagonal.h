// The real block-diagonal form of a general real matrix: what makes an exact propagation step cost O(n).
//
// A is balanced, ordered by its strongly connected states (so that a cascade, say an actuator's lag before a network,
// keeps exactly the eigenvalues of its members, a rigid body its exact zero), brought to real Schur form, and decoupled
// by solving Sylvester equations between its 1x1 and 2x2 blocks. Two blocks whose decoupling needs a large transform
// (near-defective eigenvalues) stay together in one larger block; exactly repeated eigenvalues with a full set of
// vectors separate. One step of refinement with long double residuals then makes each eigenvalue right to its last
// bits. Large networks, also behind lags, have ways of their own (block_newton.h, block_cascade.h).
#pragma once

#include <Eigen/Dense>
#include <string>
#include <vector>

namespace dynoproof::mechanics {

/// T^-1 A T = L, L block-diagonal.
struct BlockDiagonal {
  /// Above this condition of T the form falls back to one dense block.
  static constexpr double kWorstCondition = 1e6;

  struct Block {
    int first;  // row and column in L
    int size;
    bool pair;                 // [a b; -b a] with b > 0
    double natural_frequency;  // smallest |eigenvalue| of the block [rad/s]
  };

  Eigen::MatrixXd T, T_inverse;  // n x n
  Eigen::MatrixXd L;             // n x n
  std::vector<Block> blocks;     // pairs by rising |eigenvalue|, then larger blocks, then real eigenvalues
  double condition = 1.0;        // 2-norm condition of T, in balanced coordinates
  bool dense_fallback = false;   // one dense block of all (> 2) states: T too ill-conditioned, or nothing separates

  int pairs() const;
  /// "71 pairs, 1 real, condition 3.2" or "dense (n = 12): .."; for the run's record.
  std::string Summary() const;
};

/// Decomposes a square, finite matrix (asserted).
BlockDiagonal BlockDiagonalise(const Eigen::MatrixXd& A);

}  // namespace dynoproof::mechanics
