#include "linear/modal_form.h"

#include <algorithm>
#include <cassert>
#include <cmath>

#include "linear/dense.h"

namespace dynoproof::mechanics {

using Eigen::MatrixXd;
using Eigen::VectorXd;

ModalForm ModalForm::Build(const LinearSystem& system, BlockDiagonal diagonal) {
  ModalForm form;
  form.condition = diagonal.condition;
  form.dense_fallback = diagonal.dense_fallback;
  form.blocks = std::move(diagonal.blocks);
  form.L = std::move(diagonal.L);
  form.T = std::move(diagonal.T);
  form.T_inverse = std::move(diagonal.T_inverse);
  form.B = form.T_inverse * system.B;
  form.P = system.P * form.T;
  form.F = MatrixXd::Zero(system.integrators(), system.inputs());
  form.C = system.C * form.T;
  form.E = system.E;
  form.D = system.D;
  if (system.outputs() > 0) {
    for (const auto& block : form.blocks) {
      const int i = block.first;
      if (!block.pair) continue;
      const double length = std::hypot(form.C(0, i), form.C(0, i + 1));
      if (length == 0.0) continue;
      Eigen::Matrix2d turn;  // commutes with the block
      turn << form.C(0, i), -form.C(0, i + 1), form.C(0, i + 1), form.C(0, i);
      turn /= length;
      form.T.middleCols(i, 2) *= turn;
      form.P.middleCols(i, 2) *= turn;
      form.C.middleCols(i, 2) *= turn;
      form.T_inverse.middleRows(i, 2) = turn.transpose() * form.T_inverse.middleRows(i, 2);
      form.B.middleRows(i, 2) = turn.transpose() * form.B.middleRows(i, 2);
      form.C(0, i) = length;
      form.C(0, i + 1) = 0.0;
    }
  }
  form.SetLayout();
  return form;
}

ModalForm ModalForm::KeepPairs(int count) const {
  std::vector<bool> keep(blocks.size(), true);
  int pairs = 0;
  for (std::size_t b = 0; b < blocks.size(); ++b) keep[b] = !blocks[b].pair || pairs++ < count;
  return Keep(keep);
}

ModalForm ModalForm::KeepBelow(double limit) const {
  std::vector<bool> keep(blocks.size());
  for (std::size_t b = 0; b < blocks.size(); ++b) keep[b] = !(blocks[b].natural_frequency > limit);
  return Keep(keep);
}

ModalForm ModalForm::Keep(const std::vector<bool>& keep) const {
  ModalForm form = *this;
  form.blocks.clear();
  std::vector<int> kept;
  for (std::size_t b = 0; b < blocks.size(); ++b) {
    const auto& block = blocks[b];
    if (keep[b]) {
      form.blocks.push_back(block);
      form.blocks.back().first = static_cast<int>(kept.size());
      for (int i = 0; i < block.size; ++i) kept.push_back(block.first + i);
      continue;
    }
    assert(block.natural_frequency > 0.0);
    const MatrixXd rest =
        -dense::Solve(L.block(block.first, block.first, block.size, block.size), B.middleRows(block.first, block.size));
    form.D += C.middleCols(block.first, block.size) * rest;
    form.F += P.middleCols(block.first, block.size) * rest;
    form.dropped_states += block.size;
  }
  form.L = L(kept, kept);
  form.B = B(kept, Eigen::all);
  form.P = P(Eigen::all, kept);
  form.C = C(Eigen::all, kept);
  form.T = T(Eigen::all, kept);
  form.T_inverse = T_inverse(kept, Eigen::all);
  form.SetLayout();
  return form;
}

void ModalForm::Expand(const MatrixXd& follows, const std::vector<int>& kept) {
  dropped_states += static_cast<int>(follows.rows() - follows.cols());
  T = follows * T;
  MatrixXd from_all = MatrixXd::Zero(T_inverse.rows(), follows.rows());
  from_all(Eigen::all, kept) = T_inverse;
  T_inverse = std::move(from_all);
}

void ModalForm::SetLayout() {
  layout = {};
  layout.place.assign(L.rows(), 0);
  for (const auto& block : blocks) layout.pairs += block.pair ? 1 : 0;
  layout.larger_begin = layout.real_begin = 2 * StateLayout::Padded(layout.pairs);
  for (const auto& block : blocks) {
    if (block.pair || block.size == 1) continue;
    for (int i = 0; i < block.size; ++i) layout.place[block.first + i] = layout.real_begin + i;
    layout.real_begin += StateLayout::Padded(block.size);
  }
  int pair = 0;
  for (const auto& block : blocks) {
    if (block.pair) {
      const int place = pair / StateLayout::kGroup * 2 * StateLayout::kGroup + pair % StateLayout::kGroup;
      layout.place[block.first] = place;
      layout.place[block.first + 1] = place + StateLayout::kGroup;
      ++pair;
    } else if (block.size == 1) {
      layout.place[block.first] = layout.real_begin + layout.reals++;
    }
  }
  layout.integrator_begin = layout.real_begin + StateLayout::Padded(layout.reals);
  layout.integrators = integrators();
  layout.size = layout.integrator_begin + StateLayout::Padded(layout.integrators);
}

void ModalForm::SetState(const VectorXd& x, const VectorXd& p, std::span<double> state) const {
  assert(x.size() == T.rows() && p.size() == integrators() && std::ssize(state) == layout.size);
  const VectorXd z = T_inverse * x;
  std::fill(state.begin(), state.end(), 0.0);
  for (int i = 0; i < z.size(); ++i) state[layout.place[i]] = z[i];
  for (int i = 0; i < p.size(); ++i) state[layout.integrator_begin + i] = p[i];
}

void ModalForm::GetState(std::span<const double> state, VectorXd& x, VectorXd& p) const {
  assert(std::ssize(state) == layout.size);
  VectorXd z(L.rows());
  for (int i = 0; i < z.size(); ++i) z[i] = state[layout.place[i]];
  x = T * z;
  p.resize(integrators());
  for (int i = 0; i < p.size(); ++i) p[i] = state[layout.integrator_begin + i];
}

}  // namespace dynoproof::mechanics
