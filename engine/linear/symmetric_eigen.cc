#include "linear/symmetric_eigen.h"

#include <Eigen/Eigenvalues>
#include <cmath>
#include <limits>
#include <memory>
#include <utility>
#include <vector>

namespace dynoproof::mechanics {
namespace {

constexpr int kDirectSize = 200;
constexpr double kEps = std::numeric_limits<double>::epsilon();
// Eigenvalues closer than this part of the norm share a group: outside of it two vectors of inverse iteration are
// orthogonal to about eps / 1e-6 = 2e-10 without help.
constexpr double kGroupGap = 1e-6;

/// T = Q^T A Q, with Q left out when A is tridiagonal already.
struct Tridiagonal {
  Eigen::VectorXd diagonal, off;
  std::unique_ptr<Eigen::Tridiagonalization<Eigen::MatrixXd>> reduction;
};

Tridiagonal Reduce(const Eigen::MatrixXd& matrix) {
  const Eigen::Index n = matrix.rows();
  bool is_tridiagonal = true;
  for (Eigen::Index j = 0; is_tridiagonal && j + 2 < n; ++j) {
    is_tridiagonal = (matrix.col(j).tail(n - j - 2).array() == 0.0).all();
  }
  if (is_tridiagonal) return {matrix.diagonal(), matrix.diagonal(-1), nullptr};
  auto reduction = std::make_unique<Eigen::Tridiagonalization<Eigen::MatrixXd>>(matrix);
  Eigen::VectorXd diagonal = reduction->diagonal(), off = reduction->subDiagonal();
  return {std::move(diagonal), std::move(off), std::move(reduction)};
}

double Norm(const Tridiagonal& t) {
  return t.diagonal.cwiseAbs().maxCoeff() + (t.off.size() > 0 ? 2.0 * t.off.cwiseAbs().maxCoeff() : 0.0);
}

/// LU of T - shift with row exchanges (Gauss with one row of fill), to solve for the vector of inverse iteration.
class ShiftedLu {
 public:
  ShiftedLu(const Tridiagonal& t, double shift, double tiny)
      : d_(t.diagonal.array() - shift), l_(t.off), u_(t.off), u2_(Eigen::VectorXd::Zero(t.off.size())) {
    swapped_.assign(static_cast<std::size_t>(l_.size()), false);
    for (Eigen::Index i = 0; i < l_.size(); ++i) {
      const double below = l_[i];
      if (std::abs(d_[i]) >= std::abs(below)) {
        if (d_[i] == 0.0) d_[i] = tiny;
        l_[i] = below / d_[i];
        d_[i + 1] -= l_[i] * u_[i];
        continue;
      }
      swapped_[static_cast<std::size_t>(i)] = true;
      l_[i] = d_[i] / below;
      const double right = u_[i];
      d_[i] = below;
      u_[i] = d_[i + 1];
      d_[i + 1] = right - l_[i] * u_[i];
      if (i + 1 < l_.size()) {
        u2_[i] = u_[i + 1];
        u_[i + 1] = -l_[i] * u2_[i];
      }
    }
    Eigen::Index last = d_.size() - 1;
    for (Eigen::Index i = 0; i <= last; ++i) {
      if (std::abs(d_[i]) < tiny) d_[i] = std::copysign(tiny, d_[i]);
    }
  }

  void Solve(Eigen::Ref<Eigen::VectorXd> x) const {
    const Eigen::Index n = d_.size();
    for (Eigen::Index i = 0; i + 1 < n; ++i) {
      if (swapped_[static_cast<std::size_t>(i)]) std::swap(x[i], x[i + 1]);
      x[i + 1] -= l_[i] * x[i];
    }
    for (Eigen::Index i = n - 1; i >= 0; --i) {
      double sum = x[i];
      if (i + 1 < n) sum -= u_[i] * x[i + 1];
      if (i + 2 < n) sum -= u2_[i] * x[i + 2];
      x[i] = sum / d_[i];
    }
  }

 private:
  Eigen::VectorXd d_, l_, u_, u2_;
  std::vector<bool> swapped_;
};

Eigen::MatrixXd InverseIteration(const Tridiagonal& t, const Eigen::VectorXd& values) {
  const Eigen::Index n = values.size();
  const double norm = Norm(t), tiny = kEps * norm;
  Eigen::MatrixXd vectors(n, n);
  Eigen::Index group = 0;
  double shift = values[0];
  for (Eigen::Index i = 0; i < n; ++i) {
    if (i > 0 && values[i] - values[i - 1] > kGroupGap * norm) group = i;
    // Equal shifts would give equal vectors: keep them apart by a few ulps, as the eigenvalues are not known better.
    shift = i > group ? std::max(values[i], shift + 4.0 * tiny) : values[i];
    const ShiftedLu lu(t, shift, tiny);
    // A start without structure: a smooth one can be orthogonal to an antisymmetric mode.
    for (Eigen::Index r = 0; r < n; ++r) vectors(r, i) = 1.0 + 0.5 * std::sin(1.7 * static_cast<double>(r * (i + 1)));
    for (int pass = 0; pass < 3; ++pass) {
      lu.Solve(vectors.col(i));
      vectors.col(i).normalize();
      if (i > group) {
        const auto done = vectors.middleCols(group, i - group);
        for (int twice = 0; twice < 2; ++twice) vectors.col(i) -= done * (done.transpose() * vectors.col(i)).eval();
        vectors.col(i).normalize();
      }
    }
  }
  return vectors;
}

/// Whether the columns solve T v = lambda v and neighbours are orthogonal, both to 1e-8: far better than anything
/// read off a mode shape needs, far worse than what a healthy iteration gives. A NaN fails.
bool Healthy(const Tridiagonal& t, const Eigen::VectorXd& values, const Eigen::MatrixXd& vectors) {
  const Eigen::Index n = values.size();
  const double limit = 1e-8;
  for (Eigen::Index i = 0; i < n; ++i) {
    Eigen::VectorXd residual = (t.diagonal.array() - values[i]) * vectors.col(i).array();
    residual.head(n - 1) += t.off.cwiseProduct(vectors.col(i).tail(n - 1));
    residual.tail(n - 1) += t.off.cwiseProduct(vectors.col(i).head(n - 1));
    if (!(residual.norm() <= limit * Norm(t))) return false;
    for (Eigen::Index j = i + 1; j < std::min(n, i + 6); ++j) {
      if (!(std::abs(vectors.col(i).dot(vectors.col(j))) <= limit)) return false;
    }
  }
  return true;
}

}  // namespace

SymmetricEigen SolveSymmetric(const Eigen::MatrixXd& matrix) {
  if (matrix.rows() > kDirectSize) {
    const Tridiagonal t = Reduce(matrix);
    SymmetricEigen result{dense::TridiagonalValues(t.diagonal, t.off), {}};
    result.vectors = InverseIteration(t, result.values);
    if (Healthy(t, result.values, result.vectors)) {
      if (t.reduction) result.vectors = (t.reduction->matrixQ() * result.vectors).eval();
      return result;
    }
  }
  return dense::Symmetric(matrix);
}

Eigen::VectorXd SymmetricValues(const Eigen::MatrixXd& matrix) {
  if (matrix.rows() == 1) return matrix.diagonal();
  const Tridiagonal t = Reduce(matrix);
  return dense::TridiagonalValues(t.diagonal, t.off);
}

}  // namespace dynoproof::mechanics
