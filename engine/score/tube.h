// A tube in time and value around a reference: a test signal may be early, late, high or low by a stated amount.
//
//   upper(t) = max { reference(s) : |s - t| <= w } + h,   lower(t) = min { ... } - h
//
// with the half-width w in time and h in value. The test is held against it at every sample of either signal, so
// neither a coarse test nor a coarse reference hides an excursion; where either has several rows at one instant, on both
// sides of the jump (jumps.h). Sliding extremes with monotonic queues: O(n) for any w.
#pragma once

#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "score/series.h"

namespace dynoproof::score {

struct TubeOptions {
  double relative_width = 0.0;     // h over the signal's nominal; must be positive
  double nominal = 0.0;            // of the signal, in its unit; must be positive
  double time_half_width_s = 0.0;  // w >= 0
  double max_gap_s = 0.0;          // of the test; 0: three times the larger median step
  /// Between two samples a signal is known as well as its interpolation: this often as far as its own second
  /// differences let the line be off (of a held one: as the next sample is away) is added to h. 0: the line is taken at
  /// its word.
  double interpolation_room = 0.0;
  /// The part of the reference's span that is judged.
  double from_s = -std::numeric_limits<double>::infinity(), to_s = std::numeric_limits<double>::infinity();
};

/// Where the test first left the tube.
struct Divergence {
  double time_s = 0.0;
  double test = 0.0;
  double lower = 0.0;
  double upper = 0.0;
};

struct TubeResult : Outcome {
  double worst_ratio = 0.0;  // distance from the reference's range within +-w, over h: 1 is the edge, above is outside
  double worst_time_s = 0.0;
  std::optional<Divergence> first;
  double fraction_outside = 0.0;  // of the compared time
  double from_s = 0.0;
  double to_s = 0.0;
  std::size_t points = 0;  // at which the two were compared
  // One value for each point: the test, the tube's edges, and the distance as in worst_ratio.
  std::vector<double> time_s, test, lower, upper, ratio;
};

/// Holds `test` against the tube around `reference`. Passes only if both are sound, the test covers the whole reference
/// span (or the part to be judged) without gaps, and no point lies outside. A test that runs longer is judged over the
/// span of the reference.
TubeResult CompareTube(const Series& reference, const Series& test, const TubeOptions& options);

/// The same as a check of kind "tube": worst ratio against 1.
Check TubeCheck(const TubeResult& result, std::string name, std::string origin);

}  // namespace dynoproof::score
