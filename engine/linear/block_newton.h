// Newton's method on A T = T L for a block-diagonal L: the last digits of a decomposition, and the whole of it where A
// is nearly block-diagonal as it stands. A network in energy coordinates is: its damping leans on pairs of states that
// turn each other round. For 200 states that is four times as fast as going through a Schur form.
#pragma once

#include <Eigen/Dense>
#include <optional>

#include "linear/block_diagonal.h"

namespace dynoproof::mechanics {

/// X of F X - X G = H for blocks of at most 2 x 2; infinite when an eigenvalue is shared.
Eigen::MatrixXd SmallSylvester(const Eigen::MatrixXd& F, const Eigen::MatrixXd& G, const Eigen::MatrixXd& H);

/// Brings a 2 x 2 matrix with complex eigenvalues to [a b; -b a], b > 0, by columns W; false when W would be
/// ill-conditioned (a pair about to become real) or the eigenvalues are real.
bool StandardPair(const Eigen::Matrix2d& M, Eigen::Matrix2d& W, Eigen::Matrix2d& pair);

/// One step: T and L of a form whose T_inverse belongs to T, the residual A T - T L formed as `Residual` (double, long
/// double). Blocks larger than 2 stay as they are; corrections of T above `largest` are left out. Returns the largest
/// correction, left out or not; T_inverse is left to the caller.
template <class Residual>
double NewtonStep(const Eigen::MatrixXd& A, double largest, BlockDiagonal& form);

/// The decomposition of a balanced A with |A| = |A|^T whose states turn in pairs; nothing where the pairs, or what else
/// couples them, are too strongly damped for the steps to converge.
std::optional<BlockDiagonal> FromPairs(const Eigen::MatrixXd& A);

/// Blocks of at most 2 in the order of the form, columns of the size that the Schur form gives them.
void Arrange(BlockDiagonal& form);

/// 2-norm condition of T, to about a percent.
double Condition(const Eigen::MatrixXd& T, const Eigen::MatrixXd& T_inverse);

}  // namespace dynoproof::mechanics
