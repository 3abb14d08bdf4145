#include "identification/random_restart.h"

#include <algorithm>
#include <cmath>
#include <random>
#include <utility>

namespace dynoproof::identification {
namespace {

constexpr double kDeviations = 2.0;  // as wide as differences are: closer by, a step sees the same minimum
constexpr double kOfItself = 0.2;    // and no farther, where the data hardly tell a number

}  // namespace

Estimate Restarted(const EstimationProblem& problem, const Estimator& estimator, Estimate fit, int tries) {
  if (!fit.ok() || fit.hypothesis.effects.empty()) return fit;
  estimator.Score(fit);
  estimator.Derive(fit);
  std::mt19937 random(1);
  std::normal_distribution<double> deviate;
  for (int k = 0; k < tries && !problem.spent(); ++k) {
    Hypothesis beside = fit.hypothesis;
    Eigen::Index row = 0;
    for (EffectInstance& instance : beside.effects) {
      for (std::size_t i = 0; i < instance.parameters.size(); ++i, ++row) {
        const EffectParameter& info = instance.effect->info().parameters[i];
        double& value = instance.parameters[i];
        const double width = std::min(kDeviations * fit.StandardDeviation(row), kOfItself * std::abs(value));
        value = std::clamp(value + width * deviate(random), info.lower, info.upper);
      }
    }
    Estimate again = EstimateAt(problem, std::move(beside));
    again.simulations += fit.simulations;
    if (again.ok()) again = estimator.Refine(std::move(again), 8);
    if (!again.ok() || !(again.chi2 < fit.chi2)) continue;
    fit = std::move(again);
    estimator.Derive(fit);
  }
  return fit;
}

}  // namespace dynoproof::identification
