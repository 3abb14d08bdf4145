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

}  // namespace dynoproof::score
