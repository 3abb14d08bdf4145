// Records may begin otherwise than the plan by what no first sample shows.
#pragma once

#include <optional>

#include "diagnosis/inquiry.h"

namespace dynoproof::diagnosis {

/// The answer where records may begin otherwise than the plan by what no first sample shows: asked where a cause leaves nothing but
/// noise, and where such a start does so too and is not beaten. Every record has some start, so that this is the plainer story; the
/// inquiry then goes on from there.
std::optional<Answer> BegunOtherwise(Inquiry& inquiry, const Answer& answer);

}  // namespace dynoproof::diagnosis
