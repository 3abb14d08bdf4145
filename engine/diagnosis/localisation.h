// Where a simulation is wrong: signal, time, frequency, operating condition.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "diagnosis/terms.h"
#include "identification/estimation_problem.h"

namespace dynoproof::diagnosis {

struct WhereWrong {
  std::string signal;
  std::vector<std::pair<double, double>> when_s, frequency_hz;
  std::string condition;  // in words; empty: everywhere alike
};

/// Looks at the signal whose residual stands highest above `floor` (by channel, unit of the signal). Spans of time and
/// bands of frequency are those where the residual is more than twice the noise.
WhereWrong Localise(const EstimationProblem& problem, const Eigen::VectorXd& residual,
                    const std::vector<double>& floor);

/// The same of one channel.
WhereWrong LocaliseIn(const EstimationProblem& problem, const Eigen::VectorXd& residual, std::size_t channel,
                      double floor);

}  // namespace dynoproof::diagnosis
