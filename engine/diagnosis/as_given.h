// A record that the plan as given predicts far closer than it counts as measured: what a run of that plan has left, fed back.
#pragma once

#include <optional>

#include "diagnosis/inquiry.h"

namespace dynoproof::diagnosis {

/// "No effect" where the plan as given leaves, in the free run, so much less than noise in every channel, of the data that models are fitted to and
/// of those that took no part, that nothing can be told beside it. The noise of a measured record alone leaves ten times as much.
std::optional<Answer> AsGiven(Inquiry& inquiry);

}  // namespace dynoproof::diagnosis
