// How much of its limit a check takes.
#pragma once

#include "score/verdict.h"

namespace dynoproof::score {

/// value/limit, or limit/value where the limit is the least; above 1 where it is broken, no finite number where the check never came
/// to one or the limit is 0.
double ShareOfLimit(const Check& check);

}  // namespace dynoproof::score
