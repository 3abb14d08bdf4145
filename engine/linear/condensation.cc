#include "linear/condensation.h"

#include <utility>

namespace dynoproof::mechanics {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;

/// The state x2 that alone moves x1, as a fast mode's; -1: x1 is no such state.
Index FastPartner(const LinearSystem& full, Index x1, double above) {
  Index x2 = -1;
  for (Index k = 0; k < full.states(); ++k) {
    if (full.A(x1, k) == 0.0) continue;
    if (x2 >= 0 || k == x1) return -1;
    x2 = k;
  }
  const bool fast = x2 >= 0 && full.A(x1, x2) > above && full.A(x2, x1) == -full.A(x1, x2);
  return fast && (full.B.row(x1).array() == 0.0).all() && (full.P.col(x1).array() == 0.0).all() &&
                 (full.P.col(x2).array() == 0.0).all()
             ? x2
             : -1;
}

}  // namespace

Condensed Condense(const LinearSystem& full, double above) {
  const Index n = full.states();
  std::vector<std::pair<Index, Index>> fast;
  std::vector<bool> is_fast(static_cast<std::size_t>(n), false);
  for (Index i = 0; i < n; ++i) {
    const Index x2 = FastPartner(full, i, above);
    if (x2 < 0) continue;
    fast.emplace_back(i, x2);
    is_fast[static_cast<std::size_t>(i)] = is_fast[static_cast<std::size_t>(x2)] = true;
  }
  Condensed condensed;
  for (int i = 0; i < n; ++i) {
    if (!is_fast[static_cast<std::size_t>(i)]) condensed.kept.push_back(i);
  }
  const std::vector<int>& kept = condensed.kept;
  const auto k = static_cast<Index>(kept.size());
  condensed.follows = MatrixXd::Zero(n, k);
  for (Index i = 0; i < k; ++i) condensed.follows(kept[static_cast<std::size_t>(i)], i) = 1.0;
  LinearSystem& system = condensed.system;
  system = {
      full.A(kept, kept), full.B(kept, Eigen::all), full.P(Eigen::all, kept), full.C(Eigen::all, kept), full.E, full.D};
  for (const auto& [x1, x2] : fast) {
    const double stiffness = -full.A(x2, x1);
    const Eigen::RowVectorXd by_kept = full.A.row(x2)(kept) / stiffness, by_input = full.B.row(x2) / stiffness;
    condensed.follows.row(x1) = by_kept;
    // Rows that do not read x1 keep their exact zeros and symmetry, by which a network is decomposed.
    const auto add = [&](const auto& reads, auto&& own, auto&& input) {
      for (Index i = 0; i < reads.size(); ++i) {
        if (reads[i] == 0.0) continue;
        own.row(i) += reads[i] * by_kept;
        input.row(i) += reads[i] * by_input;
      }
    };
    add(Eigen::VectorXd(full.A.col(x1)(kept)), system.A, system.B);
    add(Eigen::VectorXd(full.C.col(x1)), system.C, system.D);
  }
  return condensed;
}

}  // namespace dynoproof::mechanics
