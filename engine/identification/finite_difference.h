// Derivatives of what a hypothesis predicts, by differences.
#pragma once

#include <Eigen/Dense>
#include <functional>
#include <optional>
#include <vector>

#include "identification/estimation_problem.h"
#include "identification/noise_model.h"

namespace dynoproof::identification {

/// A forward difference of a prediction.
struct Difference {
  Eigen::VectorXd change;  // of the prediction
  double step = 0.0;
  int simulations = 0;
};

/// Whether differences have to be wide: with dry friction an inertia breaks loose at one of the solver's steps or the
/// next, and a small difference sees how that moves the prediction within the same step, not how it moves it on the
/// whole. It was off by a hundred in the friction of the rarer direction.
bool NeedsWideDifferences(const std::vector<EffectInstance>& effects);

/// The difference about `here` along one unknown, of which `predicted` gives the prediction at a step. `step`: small,
/// with the sign that stays inside the bounds. With `wide` it grows up to `most` times until it changes the prediction
/// by about two standard deviations of the noise: as much as the data can tell. Nothing where a run breaks.
std::optional<Difference> DifferenceOf(const std::function<Result<Eigen::VectorXd>(double step)>& predicted,
                                       const Eigen::VectorXd& here, const Whitener& whitener, double step, bool wide,
                                       double most = 1e5);

}  // namespace dynoproof::identification
