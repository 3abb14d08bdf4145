// How far a test signal is from its reference, as one number: NRMSE, largest error, and the gain, offset and shift that
// bring the two closest together.
#pragma once

#include <optional>

#include "score/series.h"

namespace dynoproof::score {

struct NrmseOptions {
  double limit = 0.0;           // largest NRMSE that passes
  double nominal = 0.0;         // of the signal; used when the reference is constant
  double constant_limit = 0.0;  // then the largest |error| over the nominal that passes; 0: nothing passes
  double max_gap_s = 0.0;       // see CoverageFault
};

struct NrmseResult : Outcome {
  std::optional<double> nrmse;  // empty for a constant reference, where it is not defined
  double rms_error = 0.0;       // unit of the signal
  double max_error = 0.0;
  double max_error_time_s = 0.0;
};

/// RMS of (test - reference) over the samples of the reference, divided by the standard deviation of the reference. A
/// reference that is constant within round-off (4 ulp of its magnitude) has no NRMSE: it fails, unless both signals
/// agree within constant_limit * nominal everywhere.
NrmseResult Nrmse(const Series& reference, const Series& test, const NrmseOptions& options);

/// The same as a check: NRMSE against its limit, or, for a constant reference, the largest error against its own.
Check NrmseCheck(const NrmseResult& result, const NrmseOptions& options, std::string name, std::string origin);

struct MaxErrorResult : Outcome {
  double relative_error = 0.0;  // max |test - reference| / nominal
  double time_s = 0.0;
};
/// Largest error over the nominal, at every sample of the reference; passes up to `limit`.
MaxErrorResult MaxError(const Series& reference, const Series& test, double nominal, double limit,
                        double max_gap_s = 0.0);

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
