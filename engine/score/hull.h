// Hull curves of an oscillating signal, as one draws them by eye over a chirp record, and the distance between two
// hulls.
//
// The hull at t is the largest (smallest) value within a window around t. A peak between two samples is found by a
// parabola through the three samples around it where the signal is sampled well there: where neither neighbour has
// fallen below half of the peak's height over the middle of the hull (always so from 9 samples per period on). The hull
// of a sine is then right within 0.6 %; at coarser sampling the samples stand as they are and it is up to 1 - cos(pi/N)
// too small.
#pragma once

#include "score/series.h"

namespace dynoproof::score {

struct HullCurve : Outcome {
  std::vector<double> time_s;  // of the signal's samples
  std::vector<double> upper, lower;
};

/// Hull with a fixed window [s] centred on each sample. The window should hold at least one period of the oscillation;
/// it must hold at least two steps of the signal and be no longer than the record.
HullCurve Hull(const Series& signal, double window_s);

/// Hull of a chirp: the window is `periods` / frequency, the frequency [Hz] given at every sample (see ChirpFrequency),
/// and at most `longest_s`. Zero frequency is allowed. Near fast changes of the frequency windows only grow, never
/// shrink.
HullCurve AdaptiveHull(const Series& signal, std::span<const double> frequency_hz, double periods, double longest_s);

struct HullLimits {
  double global = 0.0;       // largest hull error over the largest half height of the reference's hull
  double local = 0.0;        // largest hull error over the local half height; 0: not judged
  double significant = 0.1;  // local errors count where the half height is above this part of the largest
};

struct HullError : Outcome {
  double global = 0.0;
  double global_time_s = 0.0;
  double local = 0.0;
  double local_time_s = 0.0;
  double largest_half_height = 0.0;  // (upper - lower) / 2 of the reference, unit of the signal
};

/// Largest difference of the upper or lower curves at the samples of the reference. The test's hull must cover the span
/// of the reference's; a reference that does not oscillate (half height zero) fails.
HullError CompareHulls(const HullCurve& reference, const HullCurve& test, const HullLimits& limits);

/// The same as a check of kind "hull" on the global error (a breach of the local limit shows in verdict and
/// explanation).
Check HullCheck(const HullError& error, const HullLimits& limits, std::string name, std::string origin);

}  // namespace dynoproof::score
