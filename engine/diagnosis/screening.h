// A first look at every candidate: how much of the residual its signature (the change of the prediction at small
// strength) explains, for all signals jointly, beside the nuisance parameters. A few simulations a candidate.
#pragma once

#include <functional>
#include <vector>

#include "diagnosis/candidates.h"
#include "diagnosis/terms.h"
#include "identification/estimator.h"

namespace dynoproof::diagnosis {

struct Screened {
  std::size_t candidate = 0;
  std::vector<double> parameters;  // where to search on
  double chi2 = 0.0, criterion = 0.0;
  double left = 1.0;            // of the base's residual power at best, whatever the colour of the noise ...
  std::vector<double> closest;  // ... and where; empty: nowhere less than the base leaves
  /// Smallest first strength whose signature would stand out, in the parameter's unit; NaN: not defined.
  double smallest = 0.0;
  int simulations = 0;
  bool promising = false;  // gained enough to be fitted fully
};

/// Screens the candidates on top of `base` (its effects and nuisance parameters). Sorted by criterion, best first;
/// candidates that cannot be simulated are left out. `threshold`: gain of chi2 that counts as seen.
std::vector<Screened> Screen(const EstimationProblem& problem, const Estimator& estimator, const Estimate& base,
                             const std::vector<Candidate>& candidates, double threshold,
                             const std::function<void(double)>& progress);

}  // namespace dynoproof::diagnosis
