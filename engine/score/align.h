// Gain, offset and shift that make one signal most like another.
#pragma once

#include <span>
#include <vector>

#include "score/series.h"

namespace dynoproof::score {

/// Which parameters a fit may use.
struct FitFreedom {
  bool gain = true;
  bool offset = true;
  bool shift = true;
};

struct AlignmentFit : Outcome {
  double gain = 1.0;
  double offset = 0.0;   // unit of the signal
  double shift_s = 0.0;  // positive: the test comes late
  // Mean square of the residual over that of the difference, both where the shifted reference exists: 0 is a full
  // explanation, 1 none.
  double unexplained = 1.0;
  std::vector<double> residual;  // test minus fit, on the reference's samples from `first` on
  std::size_t first = 0;
};

/// Fits test(t) = gain reference(t - shift) + offset by least squares. The reference needs a uniform time base and 32
/// samples. Whole-sample shifts come from cross-correlation by FFT, the fraction from a 32-tap windowed sinc (error
/// below 1e-3 up to 0.4 of the sampling rate). |shift| <= a quarter of the record; among shifts that fit equally well
/// (periodic signals) the smallest counts.
AlignmentFit FitGainOffsetShift(const Series& reference, const Series& test, const FitFreedom& freedom = {});

/// The same for two arrays on one uniform base of this step; both sound and of one length of at least 32.
AlignmentFit FitArrays(std::span<const double> reference, std::span<const double> test, double step_s,
                       const FitFreedom& freedom);

}  // namespace dynoproof::score
