#include "linear/block_cascade.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <numeric>

#include "linear/block_newton.h"

namespace dynoproof::mechanics {

using Eigen::MatrixXd;
using Eigen::VectorXd;

Cascade FindCascade(const MatrixXd& A) {
  const int n = static_cast<int>(A.rows());
  // Bit j of reach[i]: j acts on i, through any number of states (Warshall's closure).
  const int words = (n + 63) / 64;
  std::vector<std::vector<std::uint64_t>> reach(n, std::vector<std::uint64_t>(words, 0));
  const auto acts = [&reach](int i, int j) { return (reach[i][j / 64] >> (j % 64) & 1) != 0; };
  for (int i = 0; i < n; ++i) {
    for (int j = 0; j < n; ++j) {
      if (i == j || A(i, j) != 0.0) reach[i][j / 64] |= std::uint64_t{1} << (j % 64);
    }
  }
  for (int k = 0; k < n; ++k) {
    for (int i = 0; i < n; ++i) {
      if (!acts(i, k)) continue;
      for (int w = 0; w < words; ++w) reach[i][w] |= reach[k][w];
    }
  }
  std::vector<int> first(n), influences(n, 0);  // smallest state of the set; how many states act on it
  for (int i = 0; i < n; ++i) {
    first[i] = i;
    for (int j = i - 1; j >= 0; --j) {
      if (acts(i, j) && acts(j, i)) first[i] = j;
    }
    for (const std::uint64_t word : reach[i]) influences[i] += std::popcount(word);
  }
  Cascade cascade;
  cascade.order.resize(n);
  std::iota(cascade.order.begin(), cascade.order.end(), 0);
  // A state that feels another without acting back feels strictly more states, so it comes first.
  std::sort(cascade.order.begin(), cascade.order.end(), [&](int a, int b) {
    if (influences[a] != influences[b]) return influences[a] > influences[b];
    return first[a] != first[b] ? first[a] < first[b] : a < b;
  });
  for (int i = 0; i < n; ++i) {
    if (i == 0 || first[cascade.order[i]] != first[cascade.order[i - 1]]) cascade.starts.push_back(i);
  }
  cascade.starts.push_back(n);
  return cascade;
}

namespace {

constexpr int kLarge = 40;     // states of a set from which its own way pays
constexpr double kNear = 1e3;  // an eigenvalue over its distance to one of another set: beyond, both stay together

/// Y (unit block upper triangular) with S Y = Y diag(S): `forms` are the diagonal blocks, one a set. False where two
/// sets nearly share an eigenvalue.
bool Free(const Cascade& cascade, const std::vector<BlockDiagonal>& forms, const MatrixXd& S, MatrixXd& Y) {
  Y.setIdentity(S.rows(), S.cols());
  for (int t = 1; t < cascade.sets(); ++t) {
    const int col = cascade.starts[t], cols = cascade.starts[t + 1] - col;
    for (int s = t - 1; s >= 0; --s) {
      const int row = cascade.starts[s], rows = cascade.starts[s + 1] - row, between = col - row - rows;
      MatrixXd rest = S.block(row, col, rows, cols);
      rest.noalias() += S.block(row, row + rows, rows, between) * Y.block(row + rows, col, between, cols);
      for (const auto& i : forms[s].blocks) {
        for (const auto& j : forms[t].blocks) {
          const MatrixXd own = rest.block(i.first, j.first, i.size, j.size);
          if ((own.array() == 0.0).all()) continue;  // stays exactly zero
          const MatrixXd Li = forms[s].L.block(i.first, i.first, i.size, i.size);
          const MatrixXd Lj = forms[t].L.block(j.first, j.first, j.size, j.size);
          const MatrixXd freed = SmallSylvester(Li, Lj, -own);
          const double size = std::max(Li.cwiseAbs().maxCoeff(), Lj.cwiseAbs().maxCoeff());
          if (!(freed.cwiseAbs().maxCoeff() * size <= kNear * own.cwiseAbs().maxCoeff())) return false;
          Y.block(row + i.first, col + j.first, i.size, j.size) = freed;
        }
      }
    }
  }
  return true;
}

/// Powers of two, one a set: sets have units of their own, and none may take or give more than its own size where the
/// units are what makes it so.
VectorXd SetScale(const Cascade& cascade, const MatrixXd& Y) {
  VectorXd scale = VectorXd::Ones(Y.rows());
  const MatrixXd apart = Y - MatrixXd::Identity(Y.rows(), Y.cols());
  for (int s = 0; s < cascade.sets(); ++s) {
    const int first = cascade.starts[s], size = cascade.starts[s + 1] - first;
    const VectorXd inverse = scale.cwiseInverse();
    const double above = (inverse.asDiagonal() * apart.middleCols(first, size)).cwiseAbs().maxCoeff();
    const double below = (apart.middleRows(first, size) * scale.asDiagonal()).cwiseAbs().maxCoeff();
    if (above <= 1.0 && below <= 1.0) continue;
    const double factor = above == 0.0 ? below : below == 0.0 ? 1.0 / above : std::sqrt(below / above);
    scale.segment(first, size).setConstant(std::exp2(std::round(std::log2(factor))));
  }
  return scale;
}

}  // namespace

std::optional<BlockDiagonal> FromSets(const MatrixXd& A) {
  if (A.rows() <= kLarge) return std::nullopt;  // one of several sets is smaller still
  const Cascade cascade = FindCascade(A);
  const int n = static_cast<int>(A.rows());
  int largest = 0;
  for (int s = 0; s < cascade.sets(); ++s) largest = std::max(largest, cascade.starts[s + 1] - cascade.starts[s]);
  if (cascade.sets() < 2 || largest < kLarge) return std::nullopt;

  std::vector<BlockDiagonal> forms;
  BlockDiagonal form;
  MatrixXd own = MatrixXd::Zero(n, n), inverse = own;  // columns and rows in the cascade's order
  form.L = MatrixXd::Zero(n, n);
  const MatrixXd ordered = A(cascade.order, cascade.order);
  for (int s = 0; s < cascade.sets(); ++s) {
    const int first = cascade.starts[s], size = cascade.starts[s + 1] - first;
    forms.push_back(BlockDiagonalise(ordered.block(first, first, size, size)));
    for (BlockDiagonal::Block block : forms.back().blocks) {
      if (block.size > 2) return std::nullopt;
      block.first += first;
      form.blocks.push_back(block);
    }
    own.block(first, first, size, size) = forms.back().T;
    inverse.block(first, first, size, size) = forms.back().T_inverse;
    form.L.block(first, first, size, size) = forms.back().L;
  }
  MatrixXd S = MatrixXd::Zero(n, n), Y;
  for (int s = 0; s < cascade.sets(); ++s) {
    const int row = cascade.starts[s], rows = cascade.starts[s + 1] - row;
    for (int t = s + 1; t < cascade.sets(); ++t) {
      const int col = cascade.starts[t], cols = cascade.starts[t + 1] - col;
      const auto coupling = ordered.block(row, col, rows, cols);
      if ((coupling.array() != 0.0).any())
        S.block(row, col, rows, cols) =
            inverse.block(row, row, rows, rows) * coupling * own.block(col, col, cols, cols);
    }
  }
  if (!Free(cascade, forms, S, Y)) return std::nullopt;
  const VectorXd scale = SetScale(cascade, Y), inverse_scale = scale.cwiseInverse();
  form.T = inverse_scale.asDiagonal() * own * Y * scale.asDiagonal();
  form.T_inverse =
      inverse_scale.asDiagonal() * Y.triangularView<Eigen::UnitUpper>().solve(inverse) * scale.asDiagonal();
  Arrange(form);
  form.condition = Condition(form.T, form.T_inverse);
  if (!(form.condition <= BlockDiagonal::kWorstCondition)) return std::nullopt;
  form.T(cascade.order, Eigen::all) = (scale.asDiagonal() * form.T).eval();
  form.T_inverse(Eigen::all, cascade.order) = (form.T_inverse * inverse_scale.asDiagonal()).eval();
  return form;
}

}  // namespace dynoproof::mechanics
