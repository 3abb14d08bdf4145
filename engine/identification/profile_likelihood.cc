#include "identification/profile_likelihood.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "identification/finite_difference.h"

namespace dynoproof::identification {
namespace {

constexpr double kFirst = 8.0;     // standard deviations: far beyond what any interval holds
constexpr double kFarther = 3.0;   // from one distance to the next
constexpr double kAgrees = 54.0;   // rise of chi2: 3.84 above the 50 that the best two of many minima differ by
constexpr double kForetold = 4.0;  // times the rise that a parabola has: twice the standard deviation
constexpr int kRefused = 2;        // in a row end the search: a single one may have come to rest too high
constexpr int kRounds = 4;

/// One parameter of a fit, numbered among those of all effects.
struct Number {
  std::size_t effect = 0, parameter = 0;
  Eigen::Index row = 0;

  double& In(Hypothesis& hypothesis) const { return hypothesis.effects[effect].parameters[parameter]; }
  const EffectParameter& InfoIn(const Estimate& fit) const {
    return fit.hypothesis.effects[effect].effect->info().parameters[parameter];
  }
};

class Reaching {
 public:
  Reaching(const EstimationProblem& problem, const Estimate& fit)
      : problem_(problem),
        best_(fit),
        estimator_(problem, WhitenerOf(problem, fit)),
        rough_(NeedsWideDifferences(fit.hypothesis.effects)) {
    estimator_.Score(best_);
  }

  void Extend(const Number& number, Reach& reach) {
    const double deviation = reach.above / kTwoSided95;
    if (!(deviation > 0.0) || !std::isfinite(deviation)) return;
    for (const double side : {-1.0, 1.0}) {
      if (problem_.spent()) return;
      if (!rough_ && IsParabola(number, side * deviation)) continue;
      double& far = side < 0.0 ? reach.below : reach.above;
      far = std::max(far, LargestDeviation(number, side * deviation));
    }
  }

 private:
  /// Whether chi2 rises as foretold where the parameter is `kFirst` deviations off and all others follow linearly.
  bool IsParabola(const Number& number, double deviation) {
    const Eigen::VectorXd step = best_.covariance.col(number.row) * (kFirst / deviation);
    Hypothesis moved = best_.hypothesis;
    Eigen::Index row = 0;
    for (EffectInstance& instance : moved.effects) {
      for (std::size_t i = 0; i < instance.parameters.size(); ++i, ++row) {
        const EffectParameter& info = instance.effect->info().parameters[i];
        instance.parameters[i] += step[row];
        if (instance.parameters[i] < info.lower || instance.parameters[i] > info.upper) return false;
      }
    }
    for (const int i : best_.nuisances.free) moved.z[static_cast<std::size_t>(i)] += step[row++];
    Estimate there = EstimateAt(problem_, std::move(moved));
    if (!there.ok()) return false;
    estimator_.Score(there);
    const double rise = (there.chi2 - best_.chi2) / (kFirst * kFirst);
    return rise > 1.0 / kForetold && rise < kForetold;
  }

  /// How far out the parameter can be held.
  double LargestDeviation(const Number& number, double deviation) {
    const EffectParameter& info = number.InfoIn(best_);
    Estimate at = best_;
    const double value = number.In(at.hypothesis);
    double agrees = 0.0, farthest = 0.0;
    int refused = 0;
    for (double distance = kFirst; refused < kRefused && !problem_.spent(); distance *= kFarther) {
      Hypothesis beside = at.hypothesis;
      number.In(beside) = std::clamp(value + distance * deviation, info.lower, info.upper);
      const double moved = std::abs(number.In(beside) - value);
      const bool bound = number.In(beside) == info.lower || number.In(beside) == info.upper;
      Estimate held = EstimateAt(problem_, std::move(beside));
      if (held.ok()) held = estimator_.Refine(std::move(held), kRounds, {.held = number.row});
      const double rise = held.ok() ? held.chi2 - best_.chi2 : HUGE_VAL;
      if (rise < kAgrees) {
        agrees = moved;
        refused = 0;
        at = std::move(held);
      } else if (refused++ == 0) {
        // Somewhere between the two, or, where nothing agreed, what a parabola through here leaves inside.
        farthest = agrees > 0.0 ? std::sqrt(agrees * moved) : kTwoSided95 * moved / std::sqrt(rise);
      }
      if (bound) break;
    }
    return std::max(agrees, farthest);
  }

  const EstimationProblem& problem_;
  Estimate best_;
  const Estimator estimator_;
  const bool rough_;
};

}  // namespace

std::vector<Reach> ByCovariance(const Estimate& fit) {
  std::vector<Reach> reaches;
  for (Eigen::Index row = 0; row < fit.parameters(); ++row) {
    const double half = kTwoSided95 * fit.StandardDeviation(row);
    reaches.push_back({half, half});
  }
  return reaches;
}

std::vector<Reach> ProfileIntervalOf(const EstimationProblem& problem, const Estimate& fit) {
  std::vector<Reach> reaches = ByCovariance(fit);
  Reaching reaching(problem, fit);
  Number number;
  for (const EffectInstance& instance : fit.hypothesis.effects) {
    for (number.parameter = 0; number.parameter < instance.parameters.size(); ++number.parameter, ++number.row)
      reaching.Extend(number, reaches[static_cast<std::size_t>(number.row)]);
    ++number.effect;
  }
  return reaches;
}

}  // namespace dynoproof::identification
