#include "diagnosis/twins.h"

#include <algorithm>
#include <limits>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "base/parallel.h"
#include "diagnosis/carry.h"
#include "diagnosis/policy.h"
#include "linear/dense.h"
#include "model/effect_size.h"

namespace dynoproof::diagnosis {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using estimation::Hypothesis;

/// A fitted model, of which another effect may replace one. `without`: the model without that one.
class Replaced {
 public:
  Replaced(const Contestant& best, std::size_t effect, Hypothesis without, const Levels& levels, std::size_t level)
      : best_(best), without_(std::move(without)), level_(level), screen_(best, levels[level], level) {
    const MatrixXd& J = fit().jacobian;
    const MatrixXd hessian = estimation::HessianOf(J, best.hypothesis);
    const auto& effects = best.hypothesis.effects();
    Index own = 0;
    for (std::size_t i = 0; i < effect; ++i) own += std::ssize(effects[i].effect->info().parameters);
    const Index count = std::ssize(effects[effect].effect->info().parameters);
    for (Index i = 0; i < J.cols(); ++i) {
      if (i < own || i >= own + count) others_.push_back(i);
    }
    columns_ = J(Eigen::all, others_);
    inverse_ = dense::PseudoInverse(hessian(others_, others_));
    const Result<VectorXd> rows = levels[level].Innovations(without_.At(StartFrom(without_, best.hypothesis, fit().q)));
    if (!rows.ok()) return;
    does_ = *rows - fit().innovations;
    WeighAs(fit(), levels.data(), does_);
  }

  /// The models in which a twin stands in that effect's place, fitted. `looked`: models whose last effects are the candidates. `first`: the level
  /// at which these were looked at.
  std::vector<Contestant> Twins(std::span<const Contestant> looked, std::size_t first, const Contestant& null,
                                const Levels& levels, const Magnitudes& magnitudes) const {
    std::vector<std::optional<Contestant>> fitted(looked.size());
    ParallelFor(fitted.size(), 0,
                [&](std::size_t i) { fitted[i] = TwinOf(looked[i], first, null, levels, magnitudes); });
    std::vector<Contestant> twins;
    for (std::optional<Contestant>& twin : fitted) {
      if (twin) twins.push_back(*std::move(twin));
    }
    return twins;
  }

 private:
  std::optional<Contestant> TwinOf(const Contestant& looked, std::size_t first, const Contestant& null,
                                   const Levels& levels, const Magnitudes& magnitudes) const {
    const auto& [effect, place] = looked.hypothesis.effects().back();
    // The best model may have taken its place away: lumps that one rotor stands for.
    if (std::ranges::count(effect->Places(best_.hypothesis.At(fit().q)), place) == 0) return std::nullopt;
    const std::size_t held = looked.Holds(first) ? first : first + 1;
    if (!looked.Holds(held)) return std::nullopt;  // broken wherever it was looked at: there is nothing to begin from
    const Hypothesis model = without_.With(*effect, place, magnitudes);
    const Index count = std::ssize(effect->info().parameters);
    const VectorXd numbers =
        looked.levels[held].q.segment(static_cast<Index>(looked.hypothesis.of_effects()) - count, count);
    const Trial both{effect, place, best_.hypothesis.With(*effect, place, magnitudes), {}, SizedWith(effect->info())};
    const std::vector<VectorXd> starts = StartsOf(both, numbers, model);
    const VectorXd* from = nullptr;
    double least = std::numeric_limits<double>::infinity();
    for (const VectorXd& start : starts) {
      const Result<VectorXd> rows = levels[level_].Innovations(model.At(start));
      if (!rows.ok()) continue;
      const double left = LogExcess(estimation::ScalesOf(levels.data(), *rows, NoiseAloneOf(fit())), levels.data());
      if (left < least) least = left, from = &start;
    }
    if (from == nullptr) return std::nullopt;
    Contestant twin(model);
    twin.levels.resize(levels.size());
    for (estimation::Estimate& one : twin.levels) one.broken = "a twin of " + best_.Name();
    estimation::Estimate& own = twin.levels[level_];
    const estimation::KnownColumns known{&best_.hypothesis, &fit()};
    own = FitRoughly(twin, null, levels, level_, *from, known);
    if (!own.ok() || IsFarBehind(own, &best_, levels, level_)) return std::nullopt;
    own = FitFully(twin, null, levels, level_, Eigen::VectorXd(own.q));
    if (!own.ok() || IsFarBehind(own, &best_, levels, level_)) return std::nullopt;
    return twin;
  }

  /// Returns where the fit of a twin may begin; nothing where the candidate is none. `both`: the best model with the candidate on top. `looked`:
  /// the numbers to which the candidate has come alone.
  std::vector<VectorXd> StartsOf(const Trial& both, const VectorXd& looked, const Hypothesis& model) const {
    constexpr double kSmall = 0.02;  // of those numbers: a column is a derivative, and a large effect is not linear
    if (does_.size() == 0) return {};
    VectorXd q = StartFrom(both.hypothesis, best_.hypothesis, fit().q);
    q.segment(both.own(), looked.size()) = looked;
    for (const std::size_t i : both.strengths) q[both.own() + static_cast<Index>(i)] *= kSmall;
    const Signature signature = screen_.Of(both, q);
    if (!signature.ran) return {};
    const VectorXd& change = signature.change;
    const VectorXd rest = change - columns_ * (inverse_ * (columns_.transpose() * change));
    const double beside_others = rest.dot(change), beside_all = signature.rest.dot(change);
    const bool alike = beside_all <= (1.0 - policy::kAlike * policy::kAlike) * beside_others;
    if (!alike || !(beside_others > 0.0)) return {};
    // It begins at the size at which it does what that effect does, or at the size to which it has come alone.
    const double size = rest.dot(does_) / beside_others;
    const VectorXd follow = inverse_ * (columns_.transpose() * (does_ - size * change));
    VectorXd there = fit().q;
    for (std::size_t k = 0; k < others_.size(); ++k) there[others_[k]] -= follow[static_cast<Index>(k)];
    VectorXd sized = StartFrom(model, best_.hypothesis, there), alone = StartFrom(model, best_.hypothesis, fit().q);
    const Index own = static_cast<Index>(model.of_effects()) - looked.size();
    sized.segment(own, looked.size()) = alone.segment(own, looked.size()) = looked;
    for (const std::size_t i : both.strengths) sized[own + static_cast<Index>(i)] *= kSmall * size;
    std::vector<VectorXd> starts;
    for (const VectorXd& start : {sized, alone})
      starts.push_back(start.cwiseMax(model.lower()).cwiseMin(model.upper()));
    return starts;
  }

  const estimation::Estimate& fit() const { return best_.levels[level_]; }

  const Contestant& best_;
  Hypothesis without_;
  std::size_t level_;
  Screen screen_;
  std::vector<Index> others_;  // coordinates of the best model but for that effect's
  MatrixXd columns_, inverse_;
  VectorXd does_;  // how that effect moves the innovations, weighted
};

/// The model that leaves least at a level, where that has an effect and columns.
std::optional<Contestant> BestOf(const Contest& contest, const Levels& levels, std::size_t level) {
  const Contestant* best = LeaderAt(contest.contestants, levels, level);
  const bool any = best != nullptr && !best->hypothesis.effects().empty() && best != &contest.contestants.front() &&
                   best->levels[level].jacobian.size() > 0;
  return any ? std::optional(*best) : std::nullopt;
}

}  // namespace

void CarryTwins(Contest& contest, const Levels& levels, std::size_t level, const Magnitudes& magnitudes) {
  const std::optional<Contestant> best = BestOf(contest, levels, level);
  if (!best) return;
  const Replaced replaced(*best, best->hypothesis.effects().size() - 1, contest.null().hypothesis, levels, level);
  for (Contestant& twin : replaced.Twins(contest.left_behind, contest.first, contest.null(), levels, magnitudes)) {
    std::erase_if(contest.left_behind, [&](const Contestant& one) { return one.Name() == twin.Name(); });
    contest.contestants.push_back(std::move(twin));
  }
}

bool CarryTwinsOfBase(Contest& contest, const Contest& before, const Hypothesis& nominal, const Levels& levels,
                      std::size_t level, const Magnitudes& magnitudes) {
  const std::optional<Contestant> best = BestOf(contest, levels, level);
  if (!best) return false;
  const auto& effects = best->hypothesis.effects();
  std::vector<Contestant> looked;
  for (const auto* some : {&before.contestants, &before.left_behind}) {
    for (const Contestant& one : *some) {
      const auto& own = one.hypothesis.effects();
      if (!own.empty() && one.share > 0.0 && std::ranges::count(effects, own.back()) == 0) looked.push_back(one);
    }
  }
  bool found = false;
  for (std::size_t k = 0; k + 1 < effects.size(); ++k) {
    Hypothesis without = nominal;
    for (std::size_t i = 0; i < effects.size(); ++i) {
      if (i != k) without = without.With(*effects[i].effect, effects[i].place, magnitudes);
    }
    const Replaced replaced(*best, k, std::move(without), levels, level);
    for (Contestant& twin : replaced.Twins(looked, before.first, contest.null(), levels, magnitudes)) {
      contest.contestants.push_back(std::move(twin));
      found = true;
    }
  }
  return found;
}

}  // namespace dynoproof::diagnosis
