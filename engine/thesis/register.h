// What the thesis adds to the harness: kinds of checks, pictures of runs, a study that campaigns may vary.
#pragma once

#include "model/registry.h"

namespace dynoproof {

/// Called beside RegisterBuiltIns. Calling it again changes nothing.
void RegisterThesis(Registry& registry);

}  // namespace dynoproof
