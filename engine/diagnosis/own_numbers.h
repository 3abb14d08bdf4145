// The nominal model with its nominal values let go: as the null of a second pass, and as an answer where several of them are wrong.
#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "diagnosis/inquiry.h"

namespace dynoproof::diagnosis {

/// The null with its nominal values let go. Where it is far from the noise, starts that were found with the nominal values are found once
/// more with what these have come to.
Contestant ReleasedNull(const Inquiry& inquiry);

/// The answer where the model's own numbers, let go together, leave nothing but noise: which of them are wrong.
std::optional<Answer> SeveralNumbers(Inquiry& inquiry, const Contest& under_priors, const Contestant& released);

/// A model that leaves nothing but noise by numbers that its priors rule out is not right as it is, and lacks no effect. `far`: which
/// (FarFromPriors()).
void TellNumbers(const std::vector<std::pair<std::string, double>>& far, Settled& settled);

}  // namespace dynoproof::diagnosis
