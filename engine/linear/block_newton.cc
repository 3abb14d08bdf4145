#include "linear/block_newton.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include "linear/dense.h"
#include "linear/matrix_product.h"

namespace dynoproof::mechanics {

using Eigen::Matrix2d;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// X of F X - X G = H for blocks of at most 2 x 2; infinite when an eigenvalue is shared.
MatrixXd SmallSylvester(const MatrixXd& F, const MatrixXd& G, const MatrixXd& H) {
  const int p = static_cast<int>(F.rows()), q = static_cast<int>(G.rows());
  if (p == 1 && q == 1) return H / (F(0, 0) - G(0, 0));
  using Small = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, 4, 4>;
  using SmallVector = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, 4, 1>;
  Small kronecker = Small::Zero(p * q, p * q);
  SmallVector right(p * q);
  for (int j = 0; j < q; ++j) {
    kronecker.block(j * p, j * p, p, p) += F;
    for (int k = 0; k < q; ++k) {
      for (int i = 0; i < p; ++i) kronecker(j * p + i, k * p + i) -= G(k, j);
    }
    right.segment(j * p, p) = H.col(j);
  }
  const Eigen::FullPivLU<Small> lu(kronecker);
  if (!lu.isInvertible()) return MatrixXd::Constant(p, q, std::numeric_limits<double>::infinity());
  const SmallVector solution = lu.solve(right);
  return Eigen::Map<const MatrixXd>(solution.data(), p, q);
}

/// Brings a 2 x 2 matrix with complex eigenvalues to [a b; -b a], b > 0, by columns W; false when W would be
/// ill-conditioned (a pair about to become real) or the eigenvalues are real.
bool StandardPair(const Eigen::Matrix2d& M, Eigen::Matrix2d& W, Eigen::Matrix2d& pair) {
  const double a = 0.5 * (M(0, 0) + M(1, 1)), d = 0.5 * (M(0, 0) - M(1, 1));
  const double b_squared = -(d * d + M(0, 1) * M(1, 0));
  constexpr double kSkew = 1e-3;  // of b over the largest entry: W then has a condition below about 1e3
  const double largest = std::max({std::abs(d), std::abs(M(0, 1)), std::abs(M(1, 0))});
  if (!(b_squared > kSkew * kSkew * largest * largest)) return false;
  const double b = std::sqrt(b_squared);
  // The eigenvector v of a + ib; W = (Re v, Im v) gives M W = W [a b; -b a].
  if (std::abs(M(0, 1)) >= std::abs(M(1, 0))) {
    W << M(0, 1), 0.0, -d, b;
  } else {
    W << d, b, M(1, 0), 0.0;
  }
  W *= std::sqrt(2.0) / W.norm();
  pair << a, b, -b, a;
  return true;
}

namespace {

/// The same for two pairs: H splits into a part that commutes with [0 1; -1 0] and one that does not; each is one
/// complex division, by the difference of the eigenvalues and by that to the conjugate.
Matrix2d PairSylvester(const Matrix2d& F, const Matrix2d& G, const Matrix2d& H) {
  const double p1 = 0.5 * (H(0, 0) + H(1, 1)), p2 = 0.5 * (H(0, 1) - H(1, 0));
  const double n1 = 0.5 * (H(0, 0) - H(1, 1)), n2 = 0.5 * (H(0, 1) + H(1, 0));
  const double a = F(0, 0) - G(0, 0), minus = F(0, 1) - G(0, 1), plus = F(0, 1) + G(0, 1);
  const double near = a * a + minus * minus, far = a * a + plus * plus;
  const double x1 = (p1 * a + p2 * minus) / near, x2 = (p2 * a - p1 * minus) / near;
  const double y1 = (n1 * a - n2 * plus) / far, y2 = (n2 * a + n1 * plus) / far;
  Matrix2d X;
  X << x1 + y1, x2 + y2, y2 - x2, x1 - y1;
  return X;
}

MatrixXd Product(const MatrixXd& A, const MatrixXd& T, double /*residual*/) { return Multiply(A, T); }

/// A is mostly zeros where it is a network's. Four columns at a time: one sum would wait for itself.
Eigen::Matrix<long double, Eigen::Dynamic, Eigen::Dynamic> Product(const MatrixXd& A, const MatrixXd& T,
                                                                   long double /*residual*/) {
  constexpr Eigen::Index kColumns = 4;
  const Eigen::Index n = A.rows();
  Eigen::Matrix<long double, Eigen::Dynamic, Eigen::Dynamic> product(n, T.cols());
  std::vector<std::pair<Eigen::Index, double>> row;
  for (Eigen::Index i = 0; i < n; ++i) {
    row.clear();
    for (Eigen::Index k = 0; k < A.cols(); ++k) {
      if (A(i, k) != 0.0) row.emplace_back(k, A(i, k));
    }
    for (Eigen::Index j = 0; j < T.cols(); j += kColumns) {
      const Eigen::Index last = T.cols() - 1;
      const double* const t[kColumns] = {&T(0, j), &T(0, std::min(j + 1, last)), &T(0, std::min(j + 2, last)),
                                         &T(0, std::min(j + 3, last))};
      long double sum0 = 0.0L, sum1 = 0.0L, sum2 = 0.0L, sum3 = 0.0L;
      for (const auto& [k, value] : row) {
        const long double a = value;
        sum0 += a * t[0][k];
        sum1 += a * t[1][k];
        sum2 += a * t[2][k];
        sum3 += a * t[3][k];
      }
      const long double sums[kColumns] = {sum0, sum1, sum2, sum3};
      for (Eigen::Index c = 0; c < kColumns && j + c < T.cols(); ++c) product(i, j + c) = sums[c];
    }
  }
  return product;
}

}  // namespace

constexpr double kRoundOff = 1e-13, kTurned = 1e-8;  // of an eigenvalue; of a vector

template <class Residual>
double NewtonStep(const MatrixXd& A, double largest, BlockDiagonal& form) {
  using Matrix = Eigen::Matrix<Residual, Eigen::Dynamic, Eigen::Dynamic>;
  Matrix residual = Product(A, form.T, Residual());
  const auto own = [&form](const BlockDiagonal::Block& b) { return form.L.block(b.first, b.first, b.size, b.size); };
  for (const auto& b : form.blocks) {
    residual.middleCols(b.first, b.size) -=
        form.T.middleCols(b.first, b.size).template cast<Residual>() * own(b).template cast<Residual>();
  }
  const MatrixXd F = Multiply(form.T_inverse, residual.template cast<double>());
  const auto n = A.rows();
  MatrixXd X = MatrixXd::Zero(n, n);
  double most = 0.0;
  for (const auto& col : form.blocks) {
    for (const auto& row : form.blocks) {
      if (row.first == col.first || row.size > 2 || col.size > 2) continue;
      const auto H = F.block(row.first, col.first, row.size, col.size);
      if ((H.array() == 0.0).all()) continue;
      const auto put = [&](const auto& correction) {
        const double size = correction.cwiseAbs().maxCoeff();
        // Equal eigenvalues, and round-off between them: any vectors of theirs are right.
        if (!(size < kTurned) && H.cwiseAbs().maxCoeff() < kRoundOff * own(row).cwiseAbs().maxCoeff()) return;
        most = size <= most ? most : size;  // not a number counts as large
        if (size < largest) X.block(row.first, col.first, row.size, col.size) = correction;
      };
      if (row.pair && col.pair) {
        put(PairSylvester(own(row), own(col), -H));
      } else {
        put(SmallSylvester(own(row), own(col), -H));
      }
    }
  }
  for (const auto& block : form.blocks) {
    const int i = block.first;
    const MatrixXd E = F.block(i, i, block.size, block.size);
    if (!block.pair) {
      form.L.block(i, i, block.size, block.size) += E;
      continue;
    }
    const double da = 0.5 * (E(0, 0) + E(1, 1)), db = 0.5 * (E(0, 1) - E(1, 0));
    const double skew = 0.5 * (E(0, 0) - E(1, 1)), shear = 0.5 * (E(0, 1) + E(1, 0));
    const double a = form.L(i, i), b = form.L(i, i + 1);
    // What does not commute with [0 1; -1 0] is turned away: b (J X - X J) = -[skew shear; shear -skew].
    X.block(i, i, 2, 2) << shear / (2.0 * b), -skew / (2.0 * b), -skew / (2.0 * b), -shear / (2.0 * b);
    form.L.block(i, i, 2, 2) << a + da, b + db, -(b + db), a + da;
  }
  form.T += Multiply(form.T, X);
  return most;
}
template double NewtonStep<double>(const MatrixXd&, double, BlockDiagonal&);
template double NewtonStep<long double>(const MatrixXd&, double, BlockDiagonal&);

namespace {

/// Signs s with s_i A_ij = s_j A_ji for all i, j; empty where there are none.
VectorXd Signature(const MatrixXd& A) {
  const auto n = A.rows();
  VectorXd signs = VectorXd::Zero(n);
  std::vector<Eigen::Index> open;
  for (Eigen::Index first = 0; first < n; ++first) {
    if (signs[first] != 0.0) continue;
    signs[first] = 1.0;
    open.push_back(first);
    while (!open.empty()) {
      const Eigen::Index i = open.back();
      open.pop_back();
      for (Eigen::Index j = 0; j < n; ++j) {
        if (A(i, j) == 0.0 && A(j, i) == 0.0) continue;
        const double sign = A(i, j) == A(j, i) ? signs[i] : A(i, j) == -A(j, i) ? -signs[i] : 0.0;
        if (sign == 0.0 || signs[j] == -sign) return {};
        if (signs[j] == 0.0) open.push_back(j);
        signs[j] = sign;
      }
    }
  }
  return signs;
}

/// The columns of T belong to pairs and reals already: their left vectors are the same columns with signs, since
/// diag(s) A is symmetric; exact where T is.
MatrixXd InverseBySigns(const VectorXd& signs, const BlockDiagonal& form) {
  MatrixXd left = form.T.transpose() * signs.asDiagonal();
  for (const auto& block : form.blocks) {
    auto rows = left.middleRows(block.first, block.size);
    if (block.pair) rows.row(1) *= -1.0;
    rows = (dense::Inverse(rows * form.T.middleCols(block.first, block.size)) * rows).eval();
  }
  return left;
}

/// Largest singular value, to about a percent.
double Norm(const MatrixXd& M) {
  VectorXd v = VectorXd::LinSpaced(M.cols(), 1.0, 2.0);
  double norm = 0.0;
  for (int i = 0; i < 30; ++i) {
    v = M.transpose() * (M * v.normalized());
    norm = std::sqrt(v.norm());
  }
  return norm;
}

/// Pairs of states that turn each other round, and single ones; false where a pair is not oscillating.
bool StartFromPairs(const MatrixXd& A, BlockDiagonal& form) {
  const int n = static_cast<int>(A.rows());
  std::vector<int> mate(n, -1);
  for (int i = 0; i < n; ++i) {
    double strongest = 0.0;
    for (int j = 0; j < n; ++j) {
      if (j == i || !(-A(i, j) * A(j, i) > strongest)) continue;
      strongest = -A(i, j) * A(j, i);
      mate[i] = j;
    }
  }
  form.T = form.T_inverse = form.L = MatrixXd::Zero(n, n);
  int first = 0;
  for (int i = 0; i < n; ++i) {
    const int j = mate[i];
    if (j < 0 || mate[j] != i) {
      form.T(i, first) = form.T_inverse(first, i) = 1.0;
      form.L(first, first) = A(i, i);
      form.blocks.push_back({first, 1, false, std::abs(A(i, i))});
      first += 1;
    } else if (i < j) {
      Matrix2d M, W, pair;
      M << A(i, i), A(i, j), A(j, i), A(j, j);
      if (!StandardPair(M, W, pair)) return false;
      const Matrix2d inverse = W.inverse();
      for (int k = 0; k < 2; ++k) {
        form.T(i, first + k) = W(0, k), form.T(j, first + k) = W(1, k);
        form.T_inverse(first + k, i) = inverse(k, 0), form.T_inverse(first + k, j) = inverse(k, 1);
      }
      form.L.block(first, first, 2, 2) = pair;
      form.blocks.push_back({first, 2, true, std::hypot(pair(0, 0), pair(0, 1))});
      first += 2;
    }
  }
  return form.pairs() > 0;
}

}  // namespace

void Arrange(BlockDiagonal& form) {
  std::vector<BlockDiagonal::Block> blocks = form.blocks;
  for (auto& b : blocks)
    b.natural_frequency = std::hypot(form.L(b.first, b.first), b.pair ? form.L(b.first, b.first + 1) : 0.0);
  std::stable_sort(blocks.begin(), blocks.end(), [](const auto& a, const auto& b) {
    return a.pair != b.pair ? a.pair : a.natural_frequency < b.natural_frequency;
  });
  const BlockDiagonal before = std::exchange(form, {MatrixXd(form.T.rows(), form.T.cols()),
                                                    MatrixXd(form.T.rows(), form.T.cols()),
                                                    MatrixXd::Zero(form.T.rows(), form.T.cols()),
                                                    {},
                                                    1.0,
                                                    false});
  int first = 0;
  for (auto b : blocks) {
    const double scale = std::sqrt(b.size) / before.T.middleCols(b.first, b.size).norm();
    form.T.middleCols(first, b.size) = scale * before.T.middleCols(b.first, b.size);
    form.T_inverse.middleRows(first, b.size) = before.T_inverse.middleRows(b.first, b.size) / scale;
    form.L.block(first, first, b.size, b.size) = before.L.block(b.first, b.first, b.size, b.size);
    b.first = first;
    form.blocks.push_back(b);
    first += b.size;
  }
}

double Condition(const MatrixXd& T, const MatrixXd& T_inverse) { return Norm(T) * Norm(T_inverse); }

std::optional<BlockDiagonal> FromPairs(const MatrixXd& A) {
  const VectorXd signs = Signature(A);
  BlockDiagonal form;
  if (signs.size() == 0 || !StartFromPairs(A, form)) return std::nullopt;
  // Each step squares what is left. A first correction beyond 0.3, or one that is not a third of the last: too strongly
  // coupled.
  constexpr double kFirst = 0.3, kEnough = 1e-7;
  constexpr int kMostSteps = 8;
  double last = kFirst / 0.3;
  for (int step = 0; last > kEnough; ++step) {
    const double most = NewtonStep<double>(A, 1.0, form);
    if (step == kMostSteps || !(most < 0.3 * last)) return std::nullopt;
    form.T_inverse = InverseBySigns(signs, form);
    last = most;
  }
  NewtonStep<long double>(A, 1.0, form);
  form.T_inverse = InverseBySigns(signs, form);
  // Equal eigenvalues leave vectors that are not orthogonal to each other: then this is no inverse.
  const VectorXd probe = VectorXd::LinSpaced(A.rows(), 1.0, 2.0);
  if (!((form.T_inverse * (form.T * probe) - probe).norm() < 1e-13 * probe.norm() * std::sqrt(A.rows())))
    return std::nullopt;
  Arrange(form);
  form.condition = Condition(form.T, form.T_inverse);
  return form;
}

}  // namespace dynoproof::mechanics
