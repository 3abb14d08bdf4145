// How far the numbers of a cause may lie from where the fit has come to rest.
#pragma once

#include <vector>

#include "identification/estimator.h"

namespace dynoproof::identification {

/// Distances from a parameter's value within which the data agree with it as well; in its unit.
struct Reach {
  double below = 0.0, above = 0.0;
};

/// By parameter of all effects, at 95 %, as the covariance of a fit says.
std::vector<Reach> ByCovariance(const Estimate& fit);
/// The same, asked of the data. A covariance tells it where chi2 is a parabola. Eight
/// standard deviations away chi2 has to be 64 higher then. Where it is not, or where dry friction makes the way rough,
/// the parameter is held there and farther out, and all else is fitted again: a number that others make up for
/// reaches as far as they do, which differences across one change of sticking and slipping do not show. Never less than
/// the covariance says.
std::vector<Reach> ProfileIntervalOf(const EstimationProblem& problem, const Estimate& fit);

}  // namespace dynoproof::identification
