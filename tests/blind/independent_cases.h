// Blind cases from the generators that share no code with the engine.
#pragma once

#include <string>

#include "tests/blind/blind_case.h"

namespace dynoproof::blind {

/// Share of the cases of a scenario with a generator that come from it; over all scenarios a fifth and more.
inline constexpr double kIndependent = 0.4;

/// Whether a scenario has such a generator.
bool HasIndependent(const std::string& scenario);

/// A record without noise. With an effect its name, place and parameters are written into `hidden`; `unknown`: one that
/// is not in the contract's list (drive line only). The same dice give the same machine with and without.
Columns FromIndependent(Case& hidden, Dice& dice, double duration_s, bool with_effect, bool unknown);

}  // namespace dynoproof::blind
