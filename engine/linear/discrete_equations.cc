#include "linear/discrete_equations.h"

#include <algorithm>
#include <cmath>

#include "linear/dense.h"

namespace dynoproof::mechanics {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr int kMostDoublings = 40;  // 1e12 periods: longer than any record
constexpr double kSettled = 1e-13;  // relative change at which a doubling has nothing left to add

constexpr double kSeen = 1e-12;  // power; amplitudes of 1e-6
// Hankel singular values, of the largest one: below kEnds a truncated state changes no gain; down to kInProduct the product of both
// Gramians tells them to three digits.
constexpr double kEnds = 1e-4, kInProduct = 1e-5;

MatrixXd Symmetric(const MatrixXd& x) { return 0.5 * (x + x.transpose()); }

/// The directions in which there is something, and how much, by its root: F = directions diag(roots) has F F' = X.
struct Root {
  MatrixXd directions;
  VectorXd roots;
};
Root RootOf(const MatrixXd& x) {
  const auto [values, vectors] = dense::Symmetric(x);
  const double limit = kSeen * std::max(values.maxCoeff(), 0.0);
  const Index kept = (values.array() > limit).count();  // ascending: the last ones
  return {vectors.rightCols(kept), values.tail(kept).cwiseSqrt()};
}

MatrixXd SquareRoot(const MatrixXd& x) {
  const Root root = RootOf(x);
  return root.directions * root.roots.asDiagonal();
}

}  // namespace

MatrixXd StationaryCovariance(const MatrixXd& A, const MatrixXd& Q) {
  MatrixXd x = Q, power = A;
  for (int i = 0; i < kMostDoublings; ++i) {
    const MatrixXd added = power * x * power.transpose();
    x += added;
    const double size = added.trace();
    if (!std::isfinite(size) || size <= kSettled * x.trace()) break;
    power = (power * power).eval();
  }
  return Symmetric(x);
}

StationaryFilter MakeStationaryFilter(const MatrixXd& A, const MatrixXd& C, const MatrixXd& Q, const VectorXd& R) {
  const Index n = A.rows();
  MatrixXd a = A.transpose(), h = Q, g = C.transpose() * R.cwiseInverse().asDiagonal() * C;
  for (int i = 0; i < kMostDoublings; ++i) {
    const MatrixXd w = dense::Inverse(MatrixXd::Identity(n, n) + g * h);
    const MatrixXd aw = a * w;
    const MatrixXd added = a.transpose() * h * w * a;
    g = Symmetric(g + aw * g * a.transpose());
    h = Symmetric(h + added);
    a = aw * a;
    if (added.cwiseAbs().maxCoeff() <= kSettled * h.cwiseAbs().maxCoeff()) break;
  }
  const MatrixXd innovation = C * h * C.transpose() + MatrixXd(R.asDiagonal());
  return {innovation.ldlt().solve(C * h).transpose(), h};
}

MatrixXd Observability(const MatrixXd& A, const MatrixXd& C, double leak) {
  return StationaryCovariance(leak * A.transpose(), C.transpose() * C);
}

MatrixXd RangeOf(const MatrixXd& gramian) { return RootOf(gramian).directions; }

BalancedPart Balance(const MatrixXd& A, const MatrixXd& B, const MatrixXd& C, double leak, int most) {
  const MatrixXd covariance = StationaryCovariance(leak * A, B * B.transpose()), moved = SquareRoot(covariance);
  const MatrixXd observability = Observability(A, C, leak), seen = SquareRoot(observability);
  if (moved.cols() == 0 || seen.cols() == 0)
    return {MatrixXd(A.rows(), 0), MatrixXd(0, A.rows()), VectorXd::Zero(A.rows())};
  const VectorXd seen_by_state =
      (observability.diagonal().cwiseMax(0.0) / observability.diagonal().maxCoeff()).cwiseSqrt();
  const auto [U, sizes, V] = dense::JacobiSvd(seen.transpose() * moved);
  const auto larger_than = [most](const auto& all, double share) {
    return std::min<Index>(most, (all.array() > share * all[0]).count());
  };
  if (const Index kept = larger_than(sizes, std::sqrt(kSeen)); kept == most || sizes.minCoeff() <= kEnds * sizes[0]) {
    const VectorXd inverse = sizes.head(kept).cwiseSqrt().cwiseInverse();
    return {moved * V.leftCols(kept) * inverse.asDiagonal(),
            inverse.asDiagonal() * U.leftCols(kept).transpose() * seen.transpose(), seen_by_state};
  }
  // Forces move something so far, as the angle of a line that turns, that rounding has ended the root of their covariance before what outputs
  // see of it was small. Seen by these, the covariance itself has the rest: S'PS = U diag(sizes^2) U'.
  const auto [powers, directions] = dense::Symmetric(Symmetric(seen.transpose() * covariance * seen));
  const VectorXd all = powers.reverse().cwiseMax(0.0).cwiseSqrt();
  const Index kept = larger_than(all, kInProduct);
  const MatrixXd by = directions.rowwise().reverse().leftCols(kept);
  const VectorXd inverse = all.head(kept).cwiseSqrt().cwiseInverse();
  return {covariance * seen * by * inverse.array().cube().matrix().asDiagonal(),
          inverse.asDiagonal() * by.transpose() * seen.transpose(), seen_by_state};
}

}  // namespace dynoproof::mechanics
