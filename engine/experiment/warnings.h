// What is no fault of a scenario and still lets a wrong result pass: warnings of `validate` and `run`.
#pragma once

#include "experiment/prepare.h"

namespace dynoproof {

/// A scenario without checks, a nonlinear one that does not compare the solvers, a relative limit that cannot fail.
void AddWarnings(const Prepared& prepared, Diagnostics& diagnostics);

}  // namespace dynoproof
