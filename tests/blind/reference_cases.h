// Blind cases from the program's own scenarios, by another solver, step and tolerance than what diagnoses.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "model/registry.h"
#include "tests/blind/blind_case.h"

namespace dynoproof::blind {

/// A record without noise of slightly other nominal values, under another excitation; with one effect or, for a pair,
/// two at different places, of those named in `only` (all, if empty). Nothing where what is hidden does not show.
/// Throws where it cannot be simulated.
std::optional<Columns> FromReference(Case& hidden, Dice& dice, double duration_s, const Registry& registry,
                                     const std::vector<std::string>& only);

}  // namespace dynoproof::blind
