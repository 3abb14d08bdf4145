// The way to the hypotheses that may account for the records: screening, fits on longer and longer parts, pairs. What
// they are worth is judged elsewhere (diagnose.h).
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "diagnosis/screening.h"
#include "diagnosis/terms.h"
#include "identification/estimator.h"
#include "identification/residual_tests.h"

namespace dynoproof::diagnosis {

struct Considered {
  std::string name, at, why_not;
  double validation_nrmse = 0.0;
};
/// Name and place of a fit; of several effects the last one's place, the others with theirs in the name.
Considered ConsideredOf(const Estimate& fit);

struct Found {
  Estimate null;               // the nominal scenario with all the freedom of its nuisance parameters
  std::vector<Estimate> fits;  // best first; single effects, or pairs where no single one accounts for the records
  std::vector<Structure> structure;  // what the best of all leaves, by channel
  std::vector<Candidate> candidates;
  std::vector<Screened> screened;      // single effects
  std::vector<Considered> considered;  // what was left behind on the way
  std::string partial;                 // why there is no more than a part of the truth; empty: nothing known
  double threshold = 0.0;              // least gain of chi2 that counts
};

struct SearchOptions {
  std::string saved_fits;  // file
  bool resume = false;
  std::function<void(const std::string& what, double fraction)> progress;
  std::vector<Hypothesis> suspects = {};  // that no screening would find
};

/// `study`: all of the training data, made of `data` cut at `training_share`. Fails where the nominal run breaks.
Result<Found> Search(const EstimationProblem& problem, const std::vector<MappedRecord>& data, double training_share,
                     const SearchOptions& options);

}  // namespace dynoproof::diagnosis
