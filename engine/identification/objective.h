// What a model misses of the records, as numbers that a fit makes small: sample by sample, band by band of the spectra,
// or by the frequency response (response_objective.h).
#pragma once

#include <Eigen/Dense>
#include <memory>
#include <utility>
#include <vector>

#include "base/status.h"
#include "identification/estimation_problem.h"

namespace dynoproof::identification {

class Objective {
 public:
  virtual ~Objective() = default;
  virtual Eigen::Index size() const = 0;
  /// size() numbers, all zero for a model that misses nothing. Fails where a run breaks.
  virtual Result<Eigen::VectorXd> Of(const Plan& plan) const = 0;
  /// Begin and count of entries that follow one another in time or frequency: their errors may be correlated.
  virtual std::vector<std::pair<Eigen::Index, Eigen::Index>> Courses() const = 0;
};

/// The error of the free run, each channel over the spread of what was measured; a record that is `in_motion` is run
/// from the start that fits it best, whatever the plan. `problem` has to outlive it.
std::unique_ptr<Objective> FreeRunObjective(const EstimationProblem& problem);

/// Root mean square of that error: NRMSE over all outputs. Fails where a run breaks.
Result<double> NrmseOf(const Objective& free_run, const Plan& plan);

/// The logarithm of measured over simulated amplitude in bands of +-10 %, by channel: every resonance weighs as much as
/// the largest, and one that is a little off is still seen, where a free run has lost its phase. Where noise is all
/// there is nothing is asked: its power is added to the simulated one. `problem` has to outlive it.
std::unique_ptr<Objective> SpectrumObjective(const EstimationProblem& problem);

}  // namespace dynoproof::identification
