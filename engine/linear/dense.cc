#include "linear/dense.h"

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <Eigen/QR>

namespace dynoproof::dense {

using Eigen::Index;
using Eigen::MatrixXcd;
using Eigen::MatrixXd;
using Eigen::VectorXcd;
using Eigen::VectorXd;

MatrixXd Inverse(const MatrixXd& A) { return A.inverse(); }

MatrixXcd ComplexInverse(const MatrixXcd& A) { return A.inverse(); }

MatrixXd Solve(const MatrixXd& A, const MatrixXd& B) { return A.partialPivLu().solve(B); }

VectorXcd ComplexSolve(const MatrixXcd& A, const VectorXcd& b) { return A.partialPivLu().solve(b); }

VectorXd SolveLdlt(const MatrixXd& A, const VectorXd& b) { return A.ldlt().solve(b); }

VectorXd LeastSquares(const MatrixXd& A, const VectorXd& b) { return A.completeOrthogonalDecomposition().solve(b); }

MatrixXd PseudoInverse(const MatrixXd& A) { return A.completeOrthogonalDecomposition().pseudoInverse(); }

ThinQr Qr(const MatrixXd& A) {
  const Eigen::HouseholderQR<MatrixXd> qr(A);
  return {qr.householderQ() * MatrixXd::Identity(A.rows(), A.cols()),
          qr.matrixQR().topRows(A.cols()).triangularView<Eigen::Upper>()};
}

}  // namespace dynoproof::dense
