// Numbers of a scenario by runs that the record corrects: one minimum where the free run has dozens (engine/estimation).
#pragma once

#include <vector>

#include "identification/identify.h"

namespace dynoproof::identification {

/// Fits through the levels of correction, and takes the numbers of that level whose expected innovations explain the seen
/// ones best (by likelihood): of an exact model the free run, of another the one that leaves as much unknown as there is; of
/// those that make the free run no worse than it was, where there are such. From the nominal values, and from other starts
/// until one ends at the noise. The starts of records that the problem's plan holds are fitted along. Intervals by the sandwich
/// there, of an inexact model the hull over the levels. Fills values, covariance, level, singular and alike of `result`; fails
/// where the nominal run breaks at every level.
Status FitCorrected(const EstimationProblem& problem, const IdentifyOptions& options, Identified& result);

}  // namespace dynoproof::identification
