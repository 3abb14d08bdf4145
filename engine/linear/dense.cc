#include "linear/dense.h"

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <Eigen/QR>
#include <limits>

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

VectorXd LeastSquares(const MatrixXd& A, const VectorXd& b) {
  if (A.size() == 0) return VectorXd::Zero(A.cols());
  return A.completeOrthogonalDecomposition().solve(b);
}

MatrixXd PseudoInverse(const MatrixXd& A) {
  if (A.size() == 0) return MatrixXd::Zero(A.cols(), A.rows());
  return A.completeOrthogonalDecomposition().pseudoInverse();
}

MatrixXd CovarianceOf(const MatrixXd& information) {
  if (information.size() == 0) return information;
  constexpr double kLeast = 1e-12;    // of a direction: rounding of the scaled matrix is some 1e-15
  constexpr double kNothing = 1e-20;  // of a number: it keeps its unit
  const VectorXd told = information.diagonal();
  const VectorXd unit = (told.array() > kNothing).select(told.cwiseMax(kNothing).cwiseSqrt().cwiseInverse(), 1.0);
  const SymmetricEigen own = Symmetric(unit.asDiagonal() * information * unit.asDiagonal());
  const MatrixXd scaled = unit.asDiagonal() * own.vectors;
  return scaled * own.values.cwiseMax(kLeast).cwiseInverse().asDiagonal() * scaled.transpose();
}

ThinQr Qr(const MatrixXd& A) {
  const Eigen::HouseholderQR<MatrixXd> qr(A);
  return {qr.householderQ() * MatrixXd::Identity(A.rows(), A.cols()),
          qr.matrixQR().topRows(A.cols()).triangularView<Eigen::Upper>()};
}

}  // namespace dynoproof::dense
