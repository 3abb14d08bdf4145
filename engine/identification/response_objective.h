// Misfits of a drive line's frequency response, from the scenario's [analysis] input to its output: the curve as a
// whole, or the two optimisation problems of the thesis. Those fit inertias and stiffnesses by where the resonances and
// the transfer zeros lie, (2.69) and (2.70), then dampings by how high the resonances are, (2.71) and (2.72). No run is
// needed: laws count as they are about rest.
#pragma once

#include <memory>
#include <vector>

#include "identification/objective.h"
#include "score/response.h"

namespace dynoproof::identification {

/// What is measured, in the first record that has both signals, the hold of its input taken out. Fails (exit code 2)
/// where there is none, where the plant has no frequency response or its signals pass stages, which are no part of it,
/// and where the input does not excite the band.
Result<score::Response> MeasuredResponse(const EstimationProblem& problem);

/// The complex logarithm of measured over modelled response, gain and phase, at frequencies 0.5 % apart or more where
/// the two signals are coherent. `study` has to outlive it, as it has to the others.
std::unique_ptr<Objective> ResponseObjective(const EstimationProblem& problem, const score::Response& measured);

/// What a frequency response shows, rising in frequency.
struct Landmarks {
  std::vector<double> resonances_hz, gains;  // gain: output over input there
  std::vector<double> zeros_hz;              // dips at which the response changes its sign
};
/// Peaks that stand out by 6 dB where the output is the input's (`coherence`: the share of it that is), the highest
/// within `apart_hz`, 60 dB below the highest of all at most. Fails without one.
Result<Landmarks> LandmarksOf(const score::Response& measured, double apart_hz);
/// Of MeasuredResponse. What counts there is how far the output lies above its noise: a sharp resonance rings on after
/// the input has passed, and has little coherence within the width that a chirp is smoothed over.
Result<Landmarks> MeasuredLandmarks(const EstimationProblem& problem);

/// Relative errors of the frequencies: the model's undamped eigenfrequencies and zeros that come closest in this order.
/// One that the model does not have counts as kMissing.
std::unique_ptr<Objective> FrequencyObjective(const EstimationProblem& problem, Landmarks measured);
/// Relative errors of the gains at the practical resonances.
std::unique_ptr<Objective> GainObjective(const EstimationProblem& problem, Landmarks measured);

/// Of `offered`, rising, the one that stands for each of `wanted`, rising: in this order, no two for the same, least
/// sum of abs(log(offered / wanted)), at most kMissing each; -1: none.
std::vector<int> Assigned(const std::vector<double>& wanted, const std::vector<double>& offered);
inline constexpr double kMissing = 0.5;

}  // namespace dynoproof::identification
