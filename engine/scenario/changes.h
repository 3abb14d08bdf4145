// The values that a scenario states, and the differences between two scenarios, as text.
#pragma once

#include <string>
#include <vector>

#include "model/value.h"

namespace dynoproof {

/// Each value in which two trees differ: "plant.inertia.I3 = 0.6 (was 0.5)", "plant.load is gone (was ...)". 2 and 2.0 are the
/// same number.
std::vector<std::string> ChangesBetween(const Value& was, const Value& is);

/// Each value of a tree as --set takes it: "plant.inertia.I3 = 0.5"; a list stands in one line.
std::vector<std::string> StatedValues(const Value& tree);

}  // namespace dynoproof
