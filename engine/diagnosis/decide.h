// Which of the fitted hypotheses stands: gain on validation parts, information criterion and nested test must agree.
#pragma once

#include <string>
#include <vector>

#include "diagnosis/terms.h"
#include "identification/estimator.h"

namespace dynoproof::diagnosis {

/// What a fit gains over the nominal hypothesis.
struct Standing {
  double chi2_gain = 0.0, criterion_gain = 0.0;
  double p_value = 1.0;          // nested F test, times the number of candidates
  double validation_gain = 0.0;  // of the whitened squares on blocks that took no part in the fit
  int blocks_better = 0;         // of policy::kBlocks
  double validation_chi2 = 0.0;
  bool significant = false;
};

/// Whitened squares on each fifth of the time, from a fit to the other four (one Newton step from the fit to all).
/// Derive() must have been called on the fit.
std::vector<double> CrossValidate(const EstimationProblem& problem, const Estimator& estimator, const Estimate& fit);

/// Least gain of chi2 that counts, for so many rows and candidates.
double Threshold(double rows, std::size_t candidates);

Standing Compare(const EstimationProblem& problem, const Estimate& nominal, const std::vector<double>& nominal_blocks,
                 const Estimate& fit, const std::vector<double>& blocks, double rows, std::size_t candidates);

/// Whether the best fit leaves more than half of what there is to explain, and more than half of the signal, in the
/// channel in which it gains most: motion that is missed may be as white as noise where it is chaotic, but not as
/// small.
bool LeavesTheSignal(const EstimationProblem& problem, const Estimate& null, const Estimate& best);

/// Drops what is more complex without being better, and returns the fits (by number) that cannot be told from the best
/// (fits[0], best criterion first).
std::vector<std::size_t> AmbiguitySet(const std::vector<Estimate>& fits, double threshold);

/// NRMSE on data that took no part in the choice, RMS over the signals: of the scenario as written, of the nominal model
/// with the values that were fitted to it alone, and of the model with the effect and the values fitted beside it.
struct HoldoutErrors {
  double before = 0.0, released = 0.0, after = 0.0;
};
/// Whether the effect gains there: on both nominal models, since otherwise it may be the fitted values that have gained.
/// One that needs values beyond their priors is contradicted, however well it predicts. `deviation`: the largest among
/// its fitted values [spreads of the prior].
bool GainsOnHoldout(const HoldoutErrors& errors, double deviation);

}  // namespace dynoproof::diagnosis
