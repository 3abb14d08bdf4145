// How far two predictions are from the measurement, and what the second gains on the first.
#pragma once

#include <map>
#include <optional>
#include <string>

#include "diagnosis/terms.h"
#include "identification/estimation_problem.h"

namespace dynoproof::diagnosis {

struct SignalGain {
  double before = 0.0, after = 0.0, lower = 0.0, upper = 0.0;  // NRMSE; 95 % interval of before - after
};

/// By signal, over the rows from share `from` of each channel on; channels with fewer than ten such rows are left out.
/// Of several records the last one that has the signal.
std::map<std::string, SignalGain> GainsOf(const EstimationProblem& problem, const Eigen::VectorXd& before,
                                          const Eigen::VectorXd& after, double from);

/// What plan `after` gains on plan `before`, both predicted for the study's records. Fails where a run breaks.
Result<std::map<std::string, SignalGain>> MeasureGains(const EstimationProblem& problem, const Plan& before,
                                                       const Plan& after, double from = 0.0);

/// A share with its 95 % interval.
struct Share {
  double value = 0.0, lower = 0.0, upper = 0.0;
};
/// The share of the squared error, all signals together, each over its standard deviation, that `after` removes of what
/// `before` leaves; the interval by drawing blocks of time anew. Nothing where there are too few rows.
std::optional<Share> ExplainedShare(const EstimationProblem& problem, const Eigen::VectorXd& before,
                                    const Eigen::VectorXd& after, double from);

}  // namespace dynoproof::diagnosis
