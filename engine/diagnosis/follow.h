// What the whole of a record hides and its beginning shows. With a gap in it a line forgets within tenths of a second
// where it came from: no free run predicts more, and no slope leads from one gap to another, since how often the sides
// meet changes in between. Dry friction sticks and slips, and how often it does changes in the same way. But the first
// few impacts or slips are predictable. Who reaches the noise there is followed.
#pragma once

#include <functional>
#include <optional>
#include <vector>

#include "diagnosis/study.h"

namespace dynoproof::diagnosis {

struct Followed {
  Hypothesis hypothesis;
  double share = 0.0;  // of the study's records that a free run predicts to the noise; 1: all of them
};

/// Share of the records that their first milliseconds are: a few impacts.
double FirstShare(const std::vector<MappedRecord>& records);

/// Hypotheses akin to the one that leads on the beginning `here`, for where it comes short.
using Relatives = std::function<std::vector<Hypothesis>(const Study& here, const Hypothesis& leader)>;

/// Follows `starts`, fitted to the share `first` of the study, through longer and longer parts: the best of those that
/// reach the noise farthest. `study`: all of the training data, without prediction windows. Nothing where nobody comes
/// twice as far, or where a longer free run would tell more than it does: what it misses later must be no more than
/// what finer substeps change.
std::optional<Followed> Follow(const Study& study, double first, std::vector<Hypothesis> starts,
                               const std::function<void(double)>& progress, const Relatives& relatives = {});

/// The same for `backlash`: every gap at every shaft.
std::optional<Followed> FollowPlay(const Study& study, const std::function<void(double)>& progress);

/// The same for the laws of dry friction, as the scenario's effects know them, at `place` or, without one, everywhere.
std::optional<Followed> FollowFriction(const Study& study, const std::optional<Place>& place,
                                       const std::function<void(double)>& progress);
/// Whether an effect is a law of dry friction.
bool IsDryFriction(const Effect& effect);
/// Whether it is one of those laws that fall with speed or differ with direction.
bool FallsOrDiffers(const Effect& friction);

}  // namespace dynoproof::diagnosis
