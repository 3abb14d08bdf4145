// Play, from the first impacts on.
#pragma once

#include "diagnosis/follow.h"

namespace dynoproof::diagnosis {

/// Share of the records that their first milliseconds are: a few impacts.
double FirstShare(const std::vector<MappedRecord>& records);

/// `backlash` by Follow(): every gap at every shaft.
std::optional<Followed> FollowPlay(const Study& study, const std::function<void(double)>& progress);

}  // namespace dynoproof::diagnosis
