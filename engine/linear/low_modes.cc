#include "linear/low_modes.h"

#include <Eigen/SparseCholesky>
#include <Eigen/SparseCore>
#include <cmath>
#include <numbers>

namespace dynoproof::mechanics {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::SparseMatrix;
using Eigen::VectorXd;

/// Orthonormal columns, up to so many.
class Basis {
 public:
  Basis(Index n, Index most, const VectorXd& rigid) : rigid_(rigid), columns_(n, most) {}

  bool full() const { return count_ == columns_.cols(); }
  Index count() const { return count_; }
  const MatrixXd& columns() const { return columns_; }

  /// Takes in what of a vector is new, and leaves that in its place; nothing where that is no more than this share of it.
  bool Take(Eigen::Ref<VectorXd> v, double least) {
    if (full()) return true;
    if (rigid_.size() > 0) v -= rigid_ * rigid_.dot(v);
    const double before = v.norm();
    const auto there = columns_.leftCols(count_);
    for (int twice = 0; twice < 2; ++twice) {
      if (rigid_.size() > 0) v -= rigid_ * rigid_.dot(v);
      v -= there * (there.transpose() * v);
    }
    if (!(v.norm() > least * before)) return false;
    v.normalize();
    columns_.col(count_++) = v;
    return true;
  }

 private:
  const VectorXd& rigid_;
  MatrixXd columns_;
  Index count_ = 0;
};

}  // namespace

MatrixXd LowModes(const MatrixXd& S, const VectorXd& rigid, const MatrixXd& forces, const MatrixXd& shapes, int count) {
  constexpr double kMost = 0.6;   // of n: beyond, the whole costs no more
  constexpr double kRest = 1e-6;  // of the largest w^2: as slow as rest to all modes but the rigid one
  // The first block holds the static answers: it loses a column only where that is round-off. In later blocks 1e-5 to 1e-4 of a column were
  // new where forces act alike, in a direction of round-off that turned with any number of the line.
  constexpr double kSome = 1e-6, kMuch = 1e-3;
  const Index n = S.cols();
  if (count <= 0 || static_cast<double>(count) > kMost * static_cast<double>(n)) return {};
  const SparseMatrix<double> sparse = S.sparseView();
  const SparseMatrix<double> A = sparse.transpose() * sparse;
  SparseMatrix<double> unit(n, n);
  unit.setIdentity();
  const double largest = 2.0 * A.diagonal().maxCoeff();
  Eigen::SimplicialLDLT<SparseMatrix<double>> factors(A + kRest * largest * unit);
  Basis basis(n, count, rigid);
  for (const auto& shape : shapes.colwise()) {
    VectorXd held = shape;
    basis.Take(held, kSome);
  }
  // Each block answers the block before at a larger shift, so that the space comes ever nearer to the lowest modes. Cosine waves excite the
  // modes that no force reaches, and replace a column that brings nothing new.
  int waves = 0;
  const VectorXd along = VectorXd::LinSpaced(n, 0.0, std::numbers::pi);
  const auto wave = [&] { return VectorXd((++waves * along).array().cos()); };
  MatrixXd block(n, forces.cols() + 2);
  block << forces, wave(), wave();
  for (bool first = true; !basis.full() && factors.info() == Eigen::Success; first = false) {
    block = factors.solve(block).eval();
    for (Index j = 0; j < block.cols(); ++j) {
      if (!basis.Take(block.col(j), first ? kSome : kMuch)) block.col(j) = wave();
      if (waves > n) return {};
    }
    const double next = static_cast<double>(basis.count()) / static_cast<double>(n);
    factors.factorize(A + largest * next * next * unit);
  }
  return basis.full() ? basis.columns() : MatrixXd();
}

}  // namespace dynoproof::mechanics
