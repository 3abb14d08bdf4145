// The best of many minima that lie side by side.
#pragma once

#include "identification/estimator.h"

namespace dynoproof::identification {

/// A fit with dry friction, from other numbers a few of its deviations away and fitted again, `tries` times: the best.
/// How often and when an inertia sticks makes the way rough: beside each other lie minima that differ in chi2 by much
/// more than one number of a law is worth, and a step downhill ends in any of them.
/// `fitter`: on the same records as the fit, which it weighs too.
Estimate Restarted(const EstimationProblem& problem, const Estimator& estimator, Estimate fit, int tries);

}  // namespace dynoproof::identification
