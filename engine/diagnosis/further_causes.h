// Once more with a cause in the model: there may be several, and of several one may stand for another.
#pragma once

#include <optional>

#include "diagnosis/inquiry.h"

namespace dynoproof::diagnosis {

inline constexpr int kMostCauses = 3;  // that are looked for one after the other

/// The answer with the causes that are found on top of it, where these say more.
Answer WithFurtherCauses(Inquiry& inquiry, Answer answer);

/// Of several effects that leave nothing but noise, but with nominal values far off, one may be right and the others stand for what is
/// missing. On top of each of them alone a further one is asked for; the answer is taken that leaves nothing but noise and is plausible.
/// Effects on top of which the answer was found are passed over. Where the budget ends before that, an answer that names nothing.
/// `alone`: effects fitted alone.
std::optional<Answer> FromItsHalves(Inquiry& inquiry, const Answer& answer, const Contest& alone);

}  // namespace dynoproof::diagnosis
