// Decompositions of matrices of any size, made by Eigen alone. Each takes 2 to 20 s to compile wherever it is named: who calls
// these, leaves that to dense*.cc. Tests take them too, as what is known to be right.
#pragma once

#include <Eigen/Core>
#include <optional>

namespace dynoproof::dense {

using MatrixXld = Eigen::Matrix<long double, Eigen::Dynamic, Eigen::Dynamic>;

/// All n of a square matrix, conjugates side by side; not numbers where the iteration does not converge.
Eigen::VectorXcd Eigenvalues(const Eigen::MatrixXd& A);

/// A = U T U^T, U orthonormal and T upper triangular but for 2 x 2 blocks; nothing where the iteration does not converge.
struct RealSchur {
  Eigen::MatrixXd U, T;
};
std::optional<RealSchur> Schur(const Eigen::MatrixXd& A);

/// Eigenvalues and eigenvectors of a symmetric matrix by the QR iteration; only its lower triangle is read.
struct SymmetricEigen {
  Eigen::VectorXd values;   // n, rising
  Eigen::MatrixXd vectors;  // n x n, orthonormal columns
};
SymmetricEigen Symmetric(const Eigen::MatrixXd& A);
Eigen::VectorXd SymmetricValues(const Eigen::MatrixXd& A);
/// Eigenvalues of the symmetric tridiagonal matrix with `diagonal` (n) and `beside` (n - 1) as its first off-diagonal, rising.
Eigen::VectorXd TridiagonalValues(const Eigen::VectorXd& diagonal, const Eigen::VectorXd& beside);

/// A = U diag(values) V^T of m x n, values falling, U of m x min(m, n) and V of n x min(m, n).
struct Svd {
  Eigen::MatrixXd U;
  Eigen::VectorXd values;
  Eigen::MatrixXd V;
};
/// By divide and conquer: for matrices of hundreds of rows.
Svd DividedSvd(const Eigen::MatrixXd& A);
/// By Jacobi's rotations: small values to more digits.
Svd JacobiSvd(const Eigen::MatrixXd& A);
/// The values of JacobiSvd() alone.
Eigen::VectorXd SingularValues(const Eigen::MatrixXd& A);

/// By LU with row exchanges: infinite or not a number where A is singular.
Eigen::MatrixXd Inverse(const Eigen::MatrixXd& A);
Eigen::MatrixXcd ComplexInverse(const Eigen::MatrixXcd& A);
Eigen::MatrixXd Solve(const Eigen::MatrixXd& A, const Eigen::MatrixXd& B);
Eigen::VectorXcd ComplexSolve(const Eigen::MatrixXcd& A, const Eigen::VectorXcd& b);

/// A symmetric and not indefinite, by L D L^T.
Eigen::VectorXd SolveLdlt(const Eigen::MatrixXd& A, const Eigen::VectorXd& b);

/// The shortest x with the least |A x - b|, by a complete orthogonal decomposition; and the matrix that gives it.
Eigen::VectorXd LeastSquares(const Eigen::MatrixXd& A, const Eigen::VectorXd& b);
Eigen::MatrixXd PseudoInverse(const Eigen::MatrixXd& A);

/// The covariance that belongs to an information matrix, symmetric and not indefinite. It is taken in units in which each number's
/// own information is 1, so that no unit is so small that rounding takes its number for known; a direction of which the matrix
/// says nothing, not a millionth of those units, is known to a million of them.
Eigen::MatrixXd CovarianceOf(const Eigen::MatrixXd& information);

/// A = Q R of m x n, m >= n, by reflections: Q of m x n with orthonormal columns, R upper triangular.
struct ThinQr {
  Eigen::MatrixXd Q, R;
};
ThinQr Qr(const Eigen::MatrixXd& A);

/// e to the A.
Eigen::MatrixXd Exponential(const Eigen::MatrixXd& A);
MatrixXld Exponential(const MatrixXld& A);

}  // namespace dynoproof::dense
