#include "linear/low_modes.h"

#include <Eigen/SparseCholesky>
#include <Eigen/SparseCore>
#include <cmath>

#include "linear/dense.h"

namespace dynoproof::mechanics {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::SparseMatrix;
using Eigen::VectorXd;

/// Orthonormal columns that grow.
class Basis {
 public:
  Basis(Index n, const VectorXd& rigid) : rigid_(rigid), columns_(n, 0) {}

  /// Takes in what of each column is new, and leaves that in its place.
  void Extend(MatrixXd& block) {
    constexpr double kNew = 1e-8;  // of a column: less is round-off of what is there already
    Index kept = 0;
    for (Index j = 0; j < block.cols(); ++j) {
      VectorXd v = block.col(j);
      const double before = v.norm();
      for (int twice = 0; twice < 2; ++twice) {
        if (rigid_.size() > 0) v -= rigid_ * rigid_.dot(v);
        v -= columns_ * (columns_.transpose() * v);
      }
      if (!(v.norm() > kNew * before)) continue;
      v.normalize();
      columns_.conservativeResize(Eigen::NoChange, columns_.cols() + 1);
      columns_.rightCols(1) = v;
      block.col(kept++) = v;
    }
    block.conservativeResize(Eigen::NoChange, kept);
  }

  const MatrixXd& columns() const { return columns_; }

 private:
  const VectorXd& rigid_;
  MatrixXd columns_;
};

/// Whether each mode within the columns that lies below the limit is one of A itself.
bool HoldTheModes(const SparseMatrix<double>& A, const MatrixXd& columns, double limit) {
  constexpr double kOff = 1e-5;  // of w^2; w itself is then off by the square of it, over the distance to the next mode
  const MatrixXd images = A * columns;
  const dense::SymmetricEigen within = dense::Symmetric(columns.transpose() * images);
  for (Index i = 0; i < within.values.size() && within.values[i] < limit * limit; ++i) {
    const VectorXd mode = within.vectors.col(i);
    if (!((images * mode - within.values[i] * (columns * mode)).norm() <= kOff * within.values[i])) return false;
  }
  return true;
}

}  // namespace

MatrixXd LowModes(const MatrixXd& S, const VectorXd& rigid, const MatrixXd& forces, const MatrixXd& shapes,
                  double limit) {
  constexpr double kMost = 0.5;    // of n: beyond, the whole costs no more
  constexpr double kShift = 0.01;  // of the limit: as slow as rest to all modes but the rigid one
  const Index n = S.cols();
  const SparseMatrix<double> sparse = S.sparseView();
  const SparseMatrix<double> A = sparse.transpose() * sparse;
  SparseMatrix<double> shifted = A, unit(n, n);
  unit.setIdentity();
  shifted += std::pow(kShift * limit, 2) * unit;
  const Eigen::SimplicialLDLT<SparseMatrix<double>> factors(shifted);
  if (factors.info() != Eigen::Success) return {};
  Basis basis(n, rigid);
  MatrixXd held = shapes;
  basis.Extend(held);
  // Blocks of a Krylov space: what the forces do, what that does in turn, and so on, the lowest modes ever more of it. A slope and a
  // bow find the modes that no force reaches.
  MatrixXd block(n, forces.cols() + 2);
  const VectorXd slope = VectorXd::LinSpaced(n, -1.0, 1.0);
  block << forces, slope, slope.cwiseAbs2();
  for (int blocks = 0; static_cast<double>(basis.columns().cols()) < kMost * static_cast<double>(n); ++blocks) {
    block = factors.solve(block).eval();
    basis.Extend(block);
    const bool all = block.cols() == 0;  // there is nothing else
    if (blocks > 0 && (all || HoldTheModes(A, basis.columns(), limit))) return basis.columns();
    if (all) break;
  }
  return {};
}

}  // namespace dynoproof::mechanics
