// Play that the search cannot see. With a gap in it a line forgets within tenths of a second where it came from, and no
// slope leads from one gap to another: how often the sides meet changes in between. But its first few impacts are
// predictable. So all gaps are tried on the first milliseconds, and those that reach the noise there are followed.
#pragma once

#include <functional>
#include <optional>

#include "diagnosis/study.h"

namespace dynoproof::diagnosis {

struct Followed {
  Hypothesis hypothesis;  // backlash at one place
  double share = 0.0;     // of the study's records that a free run predicts to the noise; 1: all of them
};

/// `study`: all of the training data. Nothing where no gap is followed through twice the first part, or where a longer
/// free run would tell more than it does: what it misses later must be no more than what finer substeps change.
std::optional<Followed> FollowPlay(const Study& study, const std::function<void(double)>& progress);

}  // namespace dynoproof::diagnosis
