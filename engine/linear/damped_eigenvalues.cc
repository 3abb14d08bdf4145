#include "linear/damped_eigenvalues.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <tuple>

#include "linear/dense.h"
#include "linear/forest.h"

namespace dynoproof::mechanics {
namespace {

using Complex = std::complex<double>;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr int kDenseNodes = 150;

/// Groups of nodes joined by any spring or damper that neither a spring nor a damper ties to the ground.
int FreeGroups(const Network& network) {
  Network joined = network;
  for (Edge& edge : joined.edges) edge.stiffness += edge.damping;
  const std::vector<int> number = joined.Parts();
  std::vector<bool> is_free(static_cast<std::size_t>(network.size()), true);
  for (const Edge& edge : joined.edges) {
    if (edge.to == kGround && edge.stiffness > 0.0) is_free[number[edge.from]] = false;
  }
  const int groups = *std::max_element(number.begin(), number.end()) + 1;
  return static_cast<int>(std::count(is_free.begin(), is_free.begin() + groups, true));
}

/// The roots of s^2 + b s + w^2, conjugate or real with the slow one first, without cancellation.
EigenvaluePair RootsOfMode(double b, double w) {
  const double half = 0.5 * b, radicand = (w - half) * (w + half);
  if (radicand > 0.0) return {{-half, std::sqrt(radicand)}, {-half, -std::sqrt(radicand)}};
  const double fast = half + std::sqrt(-radicand);
  return {-w * w / fast, -fast};
}

/// Splits into conjugate pairs (their upper members) and real eigenvalues (sorted by magnitude, falling sign).
bool Split(const std::vector<Complex>& all, std::vector<Complex>& upper, std::vector<double>& real) {
  std::size_t lower = 0;
  for (const Complex& s : all) {
    if (!std::isfinite(s.real()) || !std::isfinite(s.imag())) return false;
    if (s.imag() > 0.0) upper.push_back(s);
    if (s.imag() < 0.0) ++lower;
    if (s.imag() == 0.0) real.push_back(s.real());
  }
  std::sort(real.begin(), real.end(), std::greater<>());
  return upper.size() == lower;
}

}  // namespace

DampingEstimate EstimateDamping(const Network& network, const ModalAnalysis& modal) {
  DampingEstimate estimate;
  estimate.damping = VectorXd::Zero(modal.omega.size());
  for (const Edge& edge : network.edges) {
    if (edge.damping <= 0.0) continue;
    Eigen::RowVectorXd rate = modal.phi.row(edge.from);
    if (edge.to != kGround) rate -= modal.phi.row(edge.to);
    estimate.damping += edge.damping * rate.cwiseAbs2().transpose();
  }
  estimate.unreached = FreeGroups(network);
  if (modal.rigid > estimate.unreached) {
    const MatrixXd rigid = ModalDamping(network, modal.phi.leftCols(modal.rigid));
    estimate.rigid_decays = dense::SymmetricValues(rigid).tail(modal.rigid - estimate.unreached);
  }
  return estimate;
}

std::vector<Complex> DenseEigenvalues(const Network& network, const ModalAnalysis& modal,
                                      const DampingEstimate& estimate) {
  // Rigid-body motion that no damper reaches is split off exactly: its zeros must not be left to round-off.
  ModalAnalysis reached;
  const MatrixXd damping = ModalDamping(network, modal.phi);
  const int r = modal.rigid, kept = r - estimate.unreached;
  const int n = static_cast<int>(modal.omega.size()) - estimate.unreached;
  MatrixXd basis = MatrixXd::Zero(n + estimate.unreached, n);
  if (kept > 0) {
    basis.topLeftCorner(r, kept) = dense::Symmetric(damping.topLeftCorner(r, r)).vectors.rightCols(kept);
  }
  basis.bottomRightCorner(n - kept, n - kept).setIdentity();
  reached.rigid = kept;
  reached.omega = modal.omega.tail(n);
  if (n == 0) return {};
  const Eigen::VectorXcd values = dense::Eigenvalues(EnergyStateMatrix(reached, basis.transpose() * damping * basis));
  return {values.begin(), values.end()};
}

std::optional<std::vector<Complex>> IteratedEigenvalues(const Network& network, const ModalAnalysis& modal,
                                                        const DampingEstimate& estimate) {
  const std::optional<Forest> forest = MakeForest(network);
  if (!forest) return std::nullopt;
  const VectorXd inertias = network.Inertias();
  std::vector<Complex> roots;
  for (const double decay : estimate.rigid_decays) roots.push_back(-decay);
  for (Eigen::Index m = modal.rigid; m < modal.omega.size(); ++m) {
    const EigenvaluePair pair = RootsOfMode(estimate.damping[m], modal.omega[m]);
    roots.insert(roots.end(), {pair.first, pair.second});
  }
  // Real and conjugate starts would keep that symmetry for ever; a pair that must leave or reach the axis needs a push.
  for (std::size_t i = 0; i < roots.size(); ++i) {
    const double turn = (i % 2 == 0 ? 1.0 : -0.7) * 1e-7 * (1.0 + 0.3 * std::sin(static_cast<double>(i)));
    roots[i] *= Complex(1.0 + 0.5 * turn, turn);
  }
  const double zeros = modal.rigid + estimate.unreached;
  std::vector<bool> done(roots.size(), false);
  for (int pass = 0; pass < 60; ++pass) {
    bool any = false;
    for (std::size_t i = 0; i < roots.size(); ++i) {
      if (done[i]) continue;
      any = true;
      const Complex newton = LogDerivative(*forest, inertias, roots[i]) - zeros / roots[i];
      Complex others = 0.0;
      for (std::size_t j = 0; j < roots.size(); ++j) {
        const Complex gap = roots[i] - roots[j];
        if (j != i && gap != 0.0) others += std::conj(gap) / std::norm(gap);
      }
      const Complex step = 1.0 / (newton - others);
      if (!std::isfinite(step.real()) || !std::isfinite(step.imag())) {
        done[i] = true;  // on the root to the last bit
        continue;
      }
      roots[i] -= step;
      done[i] = std::abs(step) <= 1e-14 * std::abs(roots[i]);
    }
    if (!any) break;
  }
  // sum s = -trace(M^-1 C), sum s^2 = trace((M^-1 C)^2) - 2 trace(M^-1 K): both fail when one root was found twice.
  const MatrixXd c = inertias.cwiseInverse().asDiagonal() * network.DampingMatrix();
  const double square =
      c.cwiseProduct(c.transpose()).sum() - 2.0 * network.StiffnessMatrix().diagonal().cwiseQuotient(inertias).sum();
  Complex sum = 0.0, sum_of_squares = 0.0;
  double size = 0.0, size_of_squares = 0.0;
  for (Complex& s : roots) {
    sum += s;
    sum_of_squares += s * s;
    size += std::abs(s);
    size_of_squares += std::norm(s);
    // Eigenvalues that nearly meet on the real axis are known to about the root of the machine precision.
    if (std::abs(s.imag()) <= 1e-8 * std::abs(s)) s = s.real();
  }
  const double limit = 1e-10;  // sums of 2000 terms round to about 1e-13; a slow root found twice in place of another
                               // can hide below, but the iteration repels its roots from each other
  if (!(std::abs(sum + c.trace()) <= limit * size)) return std::nullopt;
  if (!(std::abs(sum_of_squares - square) <= limit * size_of_squares)) return std::nullopt;
  return roots;
}

Result<std::vector<EigenvaluePair>> DampedPairs(const Network& network, const ModalAnalysis& modal) {
  const int n = static_cast<int>(modal.omega.size());
  std::vector<EigenvaluePair> pairs(static_cast<std::size_t>(n));
  const DampingEstimate estimate = EstimateDamping(network, modal);
  std::vector<Complex> upper;
  std::vector<double> real;
  bool found = false;
  if (n > kDenseNodes) {
    const auto iterated = IteratedEigenvalues(network, modal, estimate);
    found = iterated && Split(*iterated, upper, real);
    if (!found) upper.clear(), real.clear();
  }
  if (!found && !Split(DenseEigenvalues(network, modal, estimate), upper, real)) {
    return Failure{"the damped eigenvalue problem did not converge", "", {}, 3};
  }
  const std::size_t decays = static_cast<std::size_t>(estimate.rigid_decays.size());
  const std::size_t elastic = static_cast<std::size_t>(n - modal.rigid);
  if (2 * upper.size() + real.size() != 2 * elastic + decays || real.size() < decays) {
    return Failure{"the damped eigenvalue problem lost eigenvalues", "", {}, 3};
  }
  // The most damped modes own the real eigenvalues; both are brought into the order of their estimates.
  std::vector<int> by_ratio(elastic);
  std::iota(by_ratio.begin(), by_ratio.end(), modal.rigid);
  const auto ratio = [&](int m) { return estimate.damping[m] / modal.omega[m]; };
  std::stable_sort(by_ratio.begin(), by_ratio.end(), [&](int a, int b) { return ratio(a) > ratio(b); });
  const std::size_t overdamped = (real.size() - decays) / 2;
  std::vector<std::pair<double, int>> slots;  // estimated magnitude, mode
  for (std::size_t i = 0; i < decays; ++i) {
    slots.emplace_back(estimate.rigid_decays[i], modal.rigid - static_cast<int>(decays) + static_cast<int>(i));
  }
  for (std::size_t i = 0; i < overdamped; ++i) {
    const EigenvaluePair guess = RootsOfMode(estimate.damping[by_ratio[i]], modal.omega[by_ratio[i]]);
    slots.emplace_back(std::abs(guess.first), by_ratio[i]);
    slots.emplace_back(std::abs(guess.second), by_ratio[i]);
  }
  std::stable_sort(slots.begin(), slots.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
  for (std::size_t i = 0; i < slots.size(); ++i) {
    EigenvaluePair& pair = pairs[slots[i].second];
    if (slots[i].second < modal.rigid || pair.first != 0.0) {
      pair.second = real[i];
    } else {
      pair.first = real[i];
    }
  }
  // Conjugate pairs: nearest first.
  std::vector<std::tuple<double, int, std::size_t>> distances;
  for (std::size_t i = overdamped; i < elastic; ++i) {
    const int m = by_ratio[i];
    const Complex guess = RootsOfMode(estimate.damping[m], modal.omega[m]).first;
    for (std::size_t j = 0; j < upper.size(); ++j) {
      distances.emplace_back(std::abs(guess - upper[j]) / modal.omega[m], m, j);
    }
  }
  std::sort(distances.begin(), distances.end());
  std::vector<bool> used(upper.size(), false);
  for (const auto& [distance, m, j] : distances) {
    if (used[j] || pairs[m].first != 0.0) continue;
    used[j] = true;
    pairs[m] = {upper[j], std::conj(upper[j])};
  }
  return pairs;
}

}  // namespace dynoproof::mechanics
