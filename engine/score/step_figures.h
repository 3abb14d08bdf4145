// Figures of merit of step and ramp responses.
//
// The rule against noise, used throughout:
//  - Levels are medians: the start over the samples before the step, the end over the last `final_part` of the record.
//  - sigma, the noise, is 1.4826 times the median absolute difference of neighbouring samples in that last part, over
//    sqrt 2.
//  - If sigma exceeds 0.1 % of the step, all times and extremes are read off the running median of five samples, and
//    every excursion (over- and undershoot, distance from the steady value) is reduced by 1.6 sigma: three times what
//    that median leaves of normal noise.
//  - A step smaller than 6 sigma is no step.
#pragma once

#include <optional>

#include "score/series.h"

namespace dynoproof::score {

struct StepOptions {
  double step_time_s = 0.0;           // when the command stepped; at or after the first sample
  double settling_band = 0.02;        // of the step
  double final_part = 0.1;            // of the time after the step, over which the response must have settled
  std::optional<double> start = {};   // the level before, if known; else from the samples up to the step
  std::optional<double> target = {};  // the level wanted; gives the steady error
};

struct StepFigures : Outcome {
  double start = 0.0;
  double steady = 0.0;
  double step = 0.0;                   // steady - start; negative for a falling step
  std::optional<double> steady_error;  // steady - target
  double overshoot_percent = 0.0;      // beyond the steady value, of the step
  double undershoot_percent = 0.0;     // the wrong way, below the start of a rising step, of the step
  double peak_time_s = 0.0;            // after the step, of the extreme in its direction
  double rise_time_s = 0.0;            // first crossing of 10 % to first crossing of 90 %
  double settling_time_s = 0.0;        // after the step; from then on within the band
  double noise_sigma = 0.0;
};

/// Figures of a rising or falling step with at least 20 samples after it. Fails where there is no step, where the
/// response has not settled by the last part of the record, or where the step time lies outside of it.
StepFigures AnalyseStep(const Series& response, const StepOptions& options);

struct RampOptions {
  double from_s = 0.0, to_s = 0.0;  // the ramp of the command
  double settled_part = 0.5;        // last part of the ramp, over which tracking counts as steady
};

struct RampFigures : Outcome {
  double command_slope = 0.0;   // unit of the signal per second
  double response_slope = 0.0;  // over the settled part
  double steady_error = 0.0;    // command - response, median over the settled part
  double delay_s = 0.0;         // steady error over the command's slope
  double largest_error = 0.0;   // |command - response| over the whole ramp, less 1.6 sigma of noise
  double largest_error_time_s = 0.0;
  double noise_sigma = 0.0;
};

/// Tracking of a ramp, rising or falling. Command and response may have different time bases; both must cover the ramp,
/// with at least 20 samples of the command inside. Fails if the command does not move.
RampFigures AnalyseRamp(const Series& command, const Series& response, const RampOptions& options);

}  // namespace dynoproof::score
