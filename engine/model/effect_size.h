// What makes an effect larger or smaller.
#pragma once

#include <cstddef>
#include <vector>

#include "model/effect.h"

namespace dynoproof {

/// Parameters, by index, that scale an effect about linearly from a neutral value which is finite and below the upper bound.
std::vector<std::size_t> StrengthsOf(const EffectInfo& effect);

/// The parameters that grow with the size of an effect: its strengths, and what is one of them by something, as the stiffness
/// of a friction that is elastic: the stretch at which it gives way stays.
std::vector<std::size_t> SizedWith(const EffectInfo& effect);

}  // namespace dynoproof
