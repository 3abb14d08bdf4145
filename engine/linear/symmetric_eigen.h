// Eigenvalues and eigenvectors of symmetric matrices, quick for the nearly tridiagonal ones that chains and soft
// rotors give.
#pragma once

#include "linear/dense.h"

namespace dynoproof::mechanics {

using dense::SymmetricEigen;

/// Eigen-decomposition of a symmetric matrix (only its lower triangle is read). Up to 200 rows this is Eigen's QR
/// iteration. Beyond, accumulating the rotations dominates (2.2 s at n = 1000), so the eigenvectors come from inverse
/// iteration on the tridiagonal form, close eigenvalues being made orthogonal to each other; the result is checked
/// (residual and orthogonality of neighbours) and replaced by the QR iteration's where the check fails.
SymmetricEigen SolveSymmetric(const Eigen::MatrixXd& matrix);

/// The eigenvalues alone, rising.
Eigen::VectorXd SymmetricValues(const Eigen::MatrixXd& matrix);

}  // namespace dynoproof::mechanics
