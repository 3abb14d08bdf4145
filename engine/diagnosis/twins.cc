#include "diagnosis/twins.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "base/parallel.h"
#include "diagnosis/policy.h"
#include "linear/dense.h"

namespace dynoproof::diagnosis {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using estimation::Hypothesis;

/// The best model of a contest as one whose last effect another one may replace.
class Replaced {
 public:
  Replaced(const Contestant& best, const Contestant& null, const Levels& levels, std::size_t level)
      : best_(best), level_(level), screen_(best, levels[level], level) {
    const MatrixXd& J = fit().jacobian;
    const MatrixXd hessian = estimation::HessianOf(J, best.hypothesis);
    const Index count = std::ssize(best.effect().info().parameters);
    const Index own = static_cast<Index>(best.hypothesis.of_effects()) - count;
    for (Index i = 0; i < J.cols(); ++i) {
      if (i < own || i >= own + count) others_.push_back(i);
    }
    columns_ = J(Eigen::all, others_);
    inverse_ = dense::PseudoInverse(hessian(others_, others_));
    const Result<VectorXd> without =
        levels[level].Innovations(null.hypothesis.At(StartFrom(null.hypothesis, best.hypothesis, fit().q)));
    if (!without.ok()) return;
    does_ = *without - fit().innovations;
    WeighAs(fit(), levels.data(), does_);
  }

  /// Where the model with this effect in its last one's place begins; nothing: it is no twin. `looked`: the model at the first look.
  std::optional<VectorXd> StartOf(const Contestant& looked, const VectorXd& q_looked,
                                  const Magnitudes& magnitudes) const {
    if (does_.size() == 0) return std::nullopt;
    const auto& [effect, place] = looked.hypothesis.effects().back();
    // The best model may have taken its place away: lumps that one rotor stands for.
    if (std::ranges::count(effect->Places(best_.hypothesis.At(fit().q)), place) == 0) return std::nullopt;
    const Trial both{effect, place, best_.hypothesis.With(*effect, place, magnitudes), {}, SizedWith(effect->info())};
    const Index count = std::ssize(effect->info().parameters);
    const VectorXd start = q_looked.segment(static_cast<Index>(looked.hypothesis.of_effects()) - count, count);
    VectorXd q = StartFrom(both.hypothesis, best_.hypothesis, fit().q);
    q.segment(both.own(), count) = start;
    const Signature signature = screen_.Of(both, q);
    if (!signature.ran) return std::nullopt;
    const VectorXd& change = signature.change;
    const VectorXd rest = change - columns_ * (inverse_ * (columns_.transpose() * change));
    const double beside_others = rest.dot(change), beside_all = signature.rest.dot(change);
    const bool alike = beside_all <= (1.0 - policy::kAlike * policy::kAlike) * beside_others;
    if (!alike || beside_others < policy::kByChance) return std::nullopt;
    return Placed(both, looked.hypothesis, start, change, rest.dot(does_) / beside_others);
  }

 private:
  const estimation::Estimate& fit() const { return best_.levels[level_]; }

  /// The start at this size, with the other numbers where they then go; nothing where the effect is bounded to the other sign.
  std::optional<VectorXd> Placed(const Trial& trial, const Hypothesis& model, const VectorXd& start,
                                 const VectorXd& change, double size) const {
    VectorXd there = fit().q;
    const VectorXd follow = inverse_ * (columns_.transpose() * (does_ - size * change));
    for (std::size_t k = 0; k < others_.size(); ++k) there[others_[k]] -= follow[static_cast<Index>(k)];
    VectorXd q = StartFrom(model, best_.hypothesis, there);
    const Index own = static_cast<Index>(model.of_effects()) - start.size();
    q.segment(own, start.size()) = start;
    for (const std::size_t i : trial.strengths) q[own + static_cast<Index>(i)] *= size;
    const VectorXd bounded = q.cwiseMax(model.lower()).cwiseMin(model.upper());
    if (size < 0.0 && bounded.segment(own, start.size()) != q.segment(own, start.size())) return std::nullopt;
    return bounded;
  }

  const Contestant& best_;
  std::size_t level_;
  Screen screen_;
  std::vector<Index> others_;  // coordinates of the best model but for its last effect's
  MatrixXd columns_, inverse_;
  VectorXd does_;  // how the best model's last effect moves the innovations, weighted
};

}  // namespace

void CarryTwins(Contest& contest, const Levels& levels, std::size_t level, const Magnitudes& magnitudes,
                const Conduct& conduct) {
  const Contestant* leader = LeaderAt(contest.contestants, levels, level);
  if (leader == nullptr || leader == &contest.contestants.front() || leader->levels[level].jacobian.size() == 0) return;
  const Contestant best = *leader;
  const Contestant& null = contest.null();
  const Replaced replaced(best, null, levels, level);
  const double far = LogLeft(best.levels[level], levels) + std::log(policy::kFarBehind);
  std::vector<std::optional<Contestant>> twins(contest.left_behind.size());
  if (conduct.spent()) return;
  ParallelFor(twins.size(), 0, [&](std::size_t i) {
    const Contestant& looked = contest.left_behind[i];
    const Hypothesis& model = looked.hypothesis;
    const std::size_t at = looked.Holds(contest.first) ? contest.first : contest.first + 1;
    const std::optional<VectorXd> from = replaced.StartOf(looked, looked.levels[at].q, magnitudes);
    if (!from) return;
    Contestant twin(model);
    twin.levels.resize(levels.size());
    for (estimation::Estimate& fit : twin.levels) fit.broken = "a twin of " + best.Name();
    const auto fit_from = [&](const VectorXd& q, const estimation::EstimatorOptions& how) {
      twin.levels[level] = AsLoudAs(null, level, estimation::Fit(model, levels[level], q, how));
      return twin.Holds(level) && LogLeft(twin.levels[level], levels) <= far;
    };
    if (!fit_from(*from, {.iterations = 10,
                          .renewals = 2,
                          .points = policy::kRoughPoints,
                          .of_excess = policy::kCarriedTo,
                          .near = true,
                          .known = estimation::KnownColumns{&best.hypothesis, &best.levels[level]}}))
      return;
    const VectorXd rough = twin.levels[level].q;
    if (!fit_from(rough, {.renewals = 6, .points = PointsFor(model), .of_excess = policy::kCarriedTo, .near = true}))
      return;
    twins[i] = std::move(twin);
  });
  for (std::optional<Contestant>& twin : twins) {
    if (!twin) continue;
    std::erase_if(contest.left_behind, [&](const Contestant& one) { return one.Name() == twin->Name(); });
    contest.contestants.push_back(*std::move(twin));
  }
}

}  // namespace dynoproof::diagnosis
