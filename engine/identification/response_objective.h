// The misfit of a drive line's frequency response, from the scenario's [analysis] input to its output. No run is needed:
// laws count as they are about rest.
#pragma once

#include <memory>
#include <utility>
#include <vector>

#include "identification/objective.h"
#include "linear/frequency_response.h"
#include "score/response.h"

namespace dynoproof::identification {

/// Frequency response of a record that has both signals of [analysis].
struct MeasuredCurve {
  score::Response response;                           // the hold of the input taken out
  std::shared_ptr<const std::vector<double>> output;  // its rows as they were recorded, in the signal's unit
  double step_s;                                      // from row to row
};

/// That of the first record that has both signals. Fails (exit code 2) where there is none, where the plant
/// has no frequency response or its signals pass stages, which are no part of it, and where the input does not excite the
/// band.
Result<MeasuredCurve> MeasuredResponse(const EstimationProblem& problem);

inline constexpr double kCoherent = 0.8;  // share of the output that is the input's, from where on a bin counts

/// The logarithm of measured over modelled gain, within +-5: an undamped resonance has no height, and a zero no depth.
double LogGain(double ratio);

/// A misfit that asks nothing of a plan but its frequency response. `problem` has to outlive it.
class ResponseMisfit : public Objective {
 public:
  explicit ResponseMisfit(const EstimationProblem& problem) : problem_(problem) {}
  std::vector<std::pair<Eigen::Index, Eigen::Index>> Courses() const override { return {{0, size()}}; }
  /// Fails (exit code 2) where the plan cannot be built or has no frequency response.
  Result<Eigen::VectorXd> Of(const Plan& plan) const final;

 protected:
  /// size() numbers; `to_hz` is where [analysis] ends.
  virtual Eigen::VectorXd ErrorOf(const mechanics::TransferFunction& model, double to_hz) const = 0;

 private:
  const EstimationProblem& problem_;
};

/// The complex logarithm of measured over modelled response, gain and phase, at frequencies 0.5 % apart or more where
/// the two signals are coherent. `problem` has to outlive it.
std::unique_ptr<Objective> ResponseObjective(const EstimationProblem& problem, const score::Response& measured);

}  // namespace dynoproof::identification
