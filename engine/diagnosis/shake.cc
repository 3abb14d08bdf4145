#include "diagnosis/shake.h"

#include <algorithm>
#include <cmath>
#include <random>
#include <utility>

namespace dynoproof::diagnosis {
namespace {

constexpr double kDeviations = 2.0;  // as wide as differences are: closer by, a step sees the same minimum
constexpr double kOfItself = 0.2;    // and no farther, where the data hardly tell a number

}  // namespace

Fit Shaken(const Study& study, const Fitter& fitter, Fit fit, int tries) {
  if (!fit.ok() || fit.hypothesis.effects.empty()) return fit;
  fitter.Weigh(fit);
  fitter.Derive(fit);
  std::mt19937 random(1);
  std::normal_distribution<double> deviate;
  for (int k = 0; k < tries; ++k) {
    Hypothesis beside = fit.hypothesis;
    Eigen::Index row = 0;
    for (Assumed& assumed : beside.effects) {
      for (std::size_t i = 0; i < assumed.parameters.size(); ++i, ++row) {
        const EffectParameter& info = assumed.effect->info().parameters[i];
        double& value = assumed.parameters[i];
        const double width = std::min(kDeviations * fit.StandardDeviation(row), kOfItself * std::abs(value));
        value = std::clamp(value + width * deviate(random), info.lower, info.upper);
      }
    }
    Fit again = FitAt(study, std::move(beside));
    again.simulations += fit.simulations;
    if (again.ok()) again = fitter.Polish(std::move(again), 8);
    if (!again.ok() || !(again.chi2 < fit.chi2)) continue;
    fit = std::move(again);
    fitter.Derive(fit);
  }
  return fit;
}

}  // namespace dynoproof::diagnosis
