// What a frequency response shows of a drive line, and the two optimisation problems of the thesis with it: inertias and
// stiffnesses by where the resonances and the transfer zeros lie, (2.69) and (2.70), then dampings by how high the
// resonances are, (2.71) and (2.72).
#pragma once

#include <memory>
#include <vector>

#include "identification/response_objective.h"

namespace dynoproof::identification {

/// Rising in frequency.
struct Landmarks {
  std::vector<double> resonances_hz, gains;  // gain: output over input there
  std::vector<double> zeros_hz;              // dips at which the response changes its sign
};
/// Peaks that stand out by 6 dB where the output is the input's (`coherence`: the share of it that is), the highest
/// within `apart_hz`, 60 dB below the highest of all at most. Fails without one.
Result<Landmarks> LandmarksOf(const score::Response& measured, double apart_hz);
/// Of MeasuredResponse, and fails as that does. What counts there is how far the output lies above its noise: a sharp
/// resonance rings on after the input has passed, and has little coherence within the width that a chirp is smoothed over.
Result<Landmarks> MeasuredLandmarks(const EstimationProblem& problem);

/// Relative errors of the frequencies: the model's undamped eigenfrequencies and zeros that come closest in this order.
/// One that the model does not have counts as kMissing. `problem` has to outlive it, as it has to the other.
std::unique_ptr<Objective> FrequencyObjective(const EstimationProblem& problem, Landmarks measured);
/// Relative errors of the gains at the practical resonances.
std::unique_ptr<Objective> GainObjective(const EstimationProblem& problem, Landmarks measured);

/// Of `offered`, rising, the one that stands for each of `wanted`, rising: in this order, no two for the same, least
/// sum of abs(log(offered / wanted)), at most kMissing each; -1: none.
std::vector<int> Assigned(const std::vector<double>& wanted, const std::vector<double>& offered);
inline constexpr double kMissing = 0.5;

}  // namespace dynoproof::identification
