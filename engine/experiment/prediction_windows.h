// Prediction in windows. Motion through a gap is chaotic: a free run forgets within a second where it came from,
// however good the model. Scenarios that say so (prediction_window_s) are compared with a record in consecutive
// windows, each of which starts from the state that the record before it tells: none of a window's own samples takes
// part.
//
// The state is that of the model itself, run beside the record and corrected at every tick by what its outputs miss:
// an extended Kalman filter. Gaps need no rule of their own: while the sides touch, the transducers see the twist; in
// free flight the filter integrates the speeds, which it knows far better than one sample does.
//
// The gains come from one model, the nominal one, and serve every hypothesis: they say how much a sample counts, which
// is a property of the record. Each hypothesis is run beside the record by itself, so that its own friction or gap, not
// the nominal one's, carries the state through the flight; and what it predicts is a smooth function of its parameters.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "base/status.h"
#include "experiment/records.h"
#include "sim/simulate.h"

namespace dynoproof {

struct Observer {
  std::int64_t window = 0;                    // ticks
  std::vector<std::string> states, outputs;   // rows and columns of a gain
  std::vector<std::vector<double>> measured;  // by output: its sample at each tick; NaN: none
  std::vector<float> gains;                   // [tick][state][output]
};

/// prediction_window_s of the plan [s]; nothing where it has none.
std::optional<double> PredictionWindow(const Plan& plan);

/// `rig`: of the nominal model, driven by the record. Fails where its run breaks, and where the record is shorter than
/// two windows.
Result<Observer> MakeObserver(const Rig& rig, const MappedRecord& record, double window_s);

/// Predicts with any model of the same machine: states that the observer does not know are not corrected. The first
/// window has no past: its rows follow the plan's own start, and compare with nothing.
Result<Samples> PredictInWindows(const Rig& rig, Solver& solver, const Observer& observer);

/// The rows of a series from `from_s` on.
Series From(const Series& series, double from_s);

}  // namespace dynoproof
