// Dry friction, from the first slips on.
#pragma once

#include "diagnosis/horizon_continuation.h"

namespace dynoproof::diagnosis {

/// The laws of dry friction by Follow(), at `place` or, without one, wherever something may rub.
std::optional<Followed> FollowFriction(const EstimationProblem& problem, const std::optional<Place>& place,
                                       const std::function<void(double)>& progress);

/// The same friction by the simplest law, which all others contain: a law of three or four numbers has to do better.
Hypothesis AsCoulomb(const EstimationProblem& problem, Hypothesis friction);

}  // namespace dynoproof::diagnosis
