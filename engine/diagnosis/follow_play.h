// Play, from the first impacts on.
#pragma once

#include "diagnosis/horizon_continuation.h"

namespace dynoproof::diagnosis {

/// Share of the records that their first milliseconds are: a few impacts.
double FirstShare(const std::vector<MappedRecord>& records);

/// `backlash` by Follow(): every gap at every shaft.
std::optional<Followed> FollowPlay(const EstimationProblem& problem, const std::function<void(double)>& progress);

}  // namespace dynoproof::diagnosis
