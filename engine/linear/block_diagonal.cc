#include "linear/block_diagonal.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include "linear/block_cascade.h"
#include "linear/block_newton.h"
#include "linear/dense.h"

namespace dynoproof::mechanics {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

/// Powers of two d that bring rows and columns of D^-1 A D to similar size (Parlett and Reinsch 1969), 1-norm.
VectorXd BalancingScale(const MatrixXd& A) {
  const int n = static_cast<int>(A.rows());
  VectorXd scale = VectorXd::Ones(n);
  constexpr int kSweeps = 100;  // far more than needed: a safety against cycles only
  bool changed = true;
  for (int sweep = 0; changed && sweep < kSweeps; ++sweep) {
    changed = false;
    for (int i = 0; i < n; ++i) {
      double column = 0.0, row = 0.0;
      for (int j = 0; j < n; ++j) {
        if (j == i) continue;
        column += std::abs(A(j, i)) * scale[i] / scale[j];
        row += std::abs(A(i, j)) * scale[j] / scale[i];
      }
      if (column == 0.0 || row == 0.0) continue;
      const double factor = std::exp2(std::round(0.5 * std::log2(row / column)));
      if (column * factor + row / factor >= 0.95 * (column + row)) continue;
      scale[i] *= factor;
      changed = true;
    }
  }
  return scale;
}

/// Q with Q^T A Q = S quasi upper triangular; false when an eigenvalue iteration did not converge.
bool CascadeSchur(const MatrixXd& A, MatrixXd& Q, MatrixXd& S) {
  const int n = static_cast<int>(A.rows());
  const Cascade cascade = FindCascade(A);
  const int sets = static_cast<int>(cascade.starts.size()) - 1;
  MatrixXd ordered(n, n), vectors = MatrixXd::Zero(n, n);
  for (int j = 0; j < n; ++j) {
    for (int i = 0; i < n; ++i) ordered(i, j) = A(cascade.order[i], cascade.order[j]);
  }
  S = MatrixXd::Zero(n, n);
  for (int s = 0; s < sets; ++s) {
    const int first = cascade.starts[s], size = cascade.starts[s + 1] - first;
    if (size == 1) {
      vectors(first, first) = 1.0;
      S(first, first) = ordered(first, first);
      continue;
    }
    const std::optional<dense::RealSchur> schur = dense::Schur(ordered.block(first, first, size, size));
    if (!schur) return false;
    vectors.block(first, first, size, size) = schur->U;
    S.block(first, first, size, size) = schur->T;
  }
  for (int s = 0; s < sets; ++s) {
    const int row = cascade.starts[s], rows = cascade.starts[s + 1] - row;
    for (int t = s + 1; t < sets; ++t) {
      const int col = cascade.starts[t], cols = cascade.starts[t + 1] - col;
      const auto coupling = ordered.block(row, col, rows, cols);
      if ((coupling.array() == 0.0).all()) continue;  // stays exactly zero
      S.block(row, col, rows, cols) =
          vectors.block(row, row, rows, rows).transpose() * coupling * vectors.block(col, col, cols, cols);
    }
  }
  Q.resize(n, n);
  for (int i = 0; i < n; ++i) Q.row(cascade.order[i]) = vectors.row(i);
  return true;
}

/// The diagonal blocks of S, and which of them must stay together.
struct Clusters {
  std::vector<int> first, size, label;
  int count() const { return static_cast<int>(first.size()); }
  void Merge(int a, int b) {
    const int from = std::max(label[a], label[b]), to = std::min(label[a], label[b]);
    for (int& l : label) {
      if (l == from) l = to;
    }
  }
};

Clusters SchurBlocks(const MatrixXd& S) {
  Clusters blocks;
  const int n = static_cast<int>(S.rows());
  for (int i = 0; i < n;) {
    const int size = i + 1 < n && S(i + 1, i) != 0.0 ? 2 : 1;
    blocks.first.push_back(i);
    blocks.size.push_back(size);
    blocks.label.push_back(blocks.count() - 1);
    i += size;
  }
  return blocks;
}

/// Y (unit block upper triangular) and N with S Y = Y N, where N couples members of one cluster only. Where an entry of
/// Y would exceed `bound` it merges two clusters and returns false: earlier columns change too, so start again.
bool TryDecouple(const MatrixXd& S, double bound, Clusters& clusters, MatrixXd& Y, MatrixXd& N) {
  const int n = static_cast<int>(S.rows());
  Y = MatrixXd::Identity(n, n);
  N = MatrixXd::Zero(n, n);
  for (int j = 0; j < clusters.count(); ++j) {
    const int cj = clusters.first[j], nj = clusters.size[j];
    N.block(cj, cj, nj, nj) = S.block(cj, cj, nj, nj);
    for (int i = j - 1; i >= 0; --i) {
      const int ci = clusters.first[i], ni = clusters.size[i], between = cj - ci - ni;
      MatrixXd rest = S.block(ci, cj, ni, nj);
      rest.noalias() += S.block(ci, ci + ni, ni, between) * Y.block(ci + ni, cj, between, nj);
      rest.noalias() -= Y.block(ci, ci + ni, ni, between) * N.block(ci + ni, cj, between, nj);
      if (clusters.label[i] == clusters.label[j]) {
        N.block(ci, cj, ni, nj) = rest;
        continue;
      }
      if ((rest.array() == 0.0).all()) continue;
      const MatrixXd solution = SmallSylvester(S.block(ci, ci, ni, ni), S.block(cj, cj, nj, nj), -rest);
      if (!(solution.cwiseAbs().maxCoeff() <= bound)) {
        clusters.Merge(i, j);
        return false;
      }
      Y.block(ci, cj, ni, nj) = solution;
    }
  }
  return true;
}

double SmallestEigenvalue(const MatrixXd& M) {
  if (M.rows() == 1) return std::abs(M(0, 0));
  return dense::Eigenvalues(M).cwiseAbs().minCoeff();
}

/// Collects the clusters as columns of T (balanced coordinates) with their blocks.
void Assemble(const MatrixXd& Q, const Clusters& clusters, const MatrixXd& Y, const MatrixXd& N, BlockDiagonal& form) {
  const int n = static_cast<int>(Q.rows());
  struct Found {
    MatrixXd columns, block;
    int kind;  // 0 pair, 1 larger, 2 real
    double frequency;
  };
  std::vector<Found> found;
  const MatrixXd vectors = Q * Y;
  for (int label = 0; label < clusters.count(); ++label) {
    std::vector<int> members;
    for (int b = 0; b < clusters.count(); ++b) {
      if (clusters.label[b] != label) continue;
      for (int i = 0; i < clusters.size[b]; ++i) members.push_back(clusters.first[b] + i);
    }
    const int size = static_cast<int>(members.size());
    if (size == 0) continue;
    Found item{MatrixXd(n, size), MatrixXd(size, size), size == 1 ? 2 : 1, 0.0};
    for (int j = 0; j < size; ++j) {
      item.columns.col(j) = vectors.col(members[j]);
      for (int i = 0; i < size; ++i) item.block(i, j) = N(members[i], members[j]);
    }
    Eigen::Matrix2d W, pair;
    if (size == 1) {
      item.columns /= item.columns.norm();
    } else {
      dense::ThinQr qr = dense::Qr(item.columns);
      item.block = qr.R * item.block * dense::Inverse(qr.R);
      item.columns = std::move(qr.Q);
      if (size == 2 && StandardPair(item.block, W, pair)) {
        item.columns = item.columns * W;
        item.block = pair;
        item.kind = 0;
      }
    }
    item.frequency = SmallestEigenvalue(item.block);
    found.push_back(std::move(item));
  }
  std::stable_sort(found.begin(), found.end(), [](const Found& a, const Found& b) {
    return a.kind != b.kind ? a.kind < b.kind : a.frequency < b.frequency;
  });
  form.T.resize(n, n);
  form.L = MatrixXd::Zero(n, n);
  form.blocks.clear();
  int first = 0;
  for (const Found& item : found) {
    const int size = static_cast<int>(item.block.rows());
    form.T.middleCols(first, size) = item.columns;
    form.L.block(first, first, size, size) = item.block;
    form.blocks.push_back({first, size, item.kind == 0, item.frequency});
    first += size;
  }
  form.T_inverse = dense::Inverse(form.T);
  // Squaring costs half the digits: still exact enough around the limit of 1e6 (1e12 of 1e16).
  const VectorXd squares = dense::SymmetricValues(form.T.transpose() * form.T);
  form.condition = squares[0] > 0.0 ? std::sqrt(squares[n - 1] / squares[0]) : std::numeric_limits<double>::infinity();
}

/// Eigenvalue errors drop from round-off of |A| to round-off of each eigenvalue itself. Over 1e5 steps of a lightly
/// damped mode that is its phase.
void Refine(const MatrixXd& A, BlockDiagonal& form) {
  // Between repeated eigenvalues a correction is undetermined and not needed: only small ones are taken.
  NewtonStep<long double>(A, 1e-4, form);
  form.T_inverse = dense::Inverse(form.T);
}

BlockDiagonal Dense(const MatrixXd& A, double condition) {
  const int n = static_cast<int>(A.rows());
  BlockDiagonal form;
  form.T = form.T_inverse = MatrixXd::Identity(n, n);
  form.L = A;
  form.blocks = {{0, n, false, SmallestEigenvalue(A)}};
  form.condition = condition;
  form.dense_fallback = true;
  return form;
}

/// Through the real Schur form of a balanced A; `dense_fallback` without a form where nothing separates well.
BlockDiagonal FromSchur(const MatrixXd& A) {
  BlockDiagonal form;
  MatrixXd Q, S, Y, N;
  if (!CascadeSchur(A, Q, S)) {
    form.condition = std::numeric_limits<double>::infinity();
    form.dense_fallback = true;
    return form;
  }
  // A cautious bound first loses nothing but time; where several moderate couplings pile up, tighter ones follow.
  for (const double bound : {1e3, 1e2, 1e1}) {
    Clusters clusters = SchurBlocks(S);
    while (!TryDecouple(S, bound, clusters, Y, N)) {
    }
    Assemble(Q, clusters, Y, N, form);
    if (form.condition <= BlockDiagonal::kWorstCondition) break;
  }
  const bool one_block = form.blocks.size() == 1 && A.rows() > 2;
  form.dense_fallback = one_block || !(form.condition <= BlockDiagonal::kWorstCondition);
  if (!form.dense_fallback) Refine(A, form);
  return form;
}

}  // namespace

int BlockDiagonal::pairs() const {
  return static_cast<int>(std::count_if(blocks.begin(), blocks.end(), [](const Block& b) { return b.pair; }));
}

std::string BlockDiagonal::Summary() const {
  const std::string condition_text = "condition " + std::to_string(condition);
  if (dense_fallback)
    return "dense (n = " + std::to_string(L.rows()) + "): no well-conditioned blocks, " + condition_text;
  int real = 0, larger = 0;
  for (const Block& block : blocks) {
    real += block.size == 1 ? 1 : 0;
    larger += !block.pair && block.size > 1 ? 1 : 0;
  }
  return std::to_string(pairs()) + " pairs, " + std::to_string(larger) + " larger blocks, " + std::to_string(real) +
         " real, " + condition_text;
}

BlockDiagonal BlockDiagonalise(const MatrixXd& A) {
  assert(A.rows() == A.cols() && A.allFinite());
  if (A.rows() == 0) return {};
  if (std::optional<BlockDiagonal> form = FromSets(A)) return *std::move(form);
  const VectorXd scale = BalancingScale(A);
  const MatrixXd balanced = scale.cwiseInverse().asDiagonal() * A * scale.asDiagonal();
  std::optional<BlockDiagonal> form = FromPairs(balanced);
  if (!form) form = FromSchur(balanced);
  if (form->dense_fallback) return Dense(A, form->condition);
  form->T = scale.asDiagonal() * form->T;
  form->T_inverse = form->T_inverse * scale.cwiseInverse().asDiagonal();
  return *std::move(form);
}

}  // namespace dynoproof::mechanics
