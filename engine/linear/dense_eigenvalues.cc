#include <Eigen/Eigenvalues>
#include <cmath>

#include "linear/dense.h"

namespace dynoproof::dense {

using Eigen::MatrixXd;
using Eigen::VectorXd;

Eigen::VectorXcd Eigenvalues(const MatrixXd& A) {
  const Eigen::EigenSolver<MatrixXd> solver(A, false);
  if (solver.info() != Eigen::Success) return Eigen::VectorXcd::Constant(A.rows(), std::nan(""));
  return solver.eigenvalues();
}

std::optional<RealSchur> Schur(const MatrixXd& A) {
  const Eigen::RealSchur<MatrixXd> schur(A);
  if (schur.info() != Eigen::Success) return std::nullopt;
  return RealSchur{schur.matrixU(), schur.matrixT()};
}

SymmetricEigen Symmetric(const MatrixXd& A) {
  const Eigen::SelfAdjointEigenSolver<MatrixXd> solver(A);
  return {solver.eigenvalues(), solver.eigenvectors()};
}

VectorXd SymmetricValues(const MatrixXd& A) {
  return Eigen::SelfAdjointEigenSolver<MatrixXd>(A, Eigen::EigenvaluesOnly).eigenvalues();
}

VectorXd TridiagonalValues(const VectorXd& diagonal, const VectorXd& beside) {
  Eigen::SelfAdjointEigenSolver<MatrixXd> solver;
  solver.computeFromTridiagonal(diagonal, beside, Eigen::EigenvaluesOnly);
  return solver.eigenvalues();
}

}  // namespace dynoproof::dense
