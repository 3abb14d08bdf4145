// What a record can tell at best: a trace of a simulation has no noise, and where the right model agrees with it to the
// last digit, the digits that a solver's step decides would count as evidence.
#pragma once

#include <vector>

#include "experiment/records.h"

namespace dynoproof::diagnosis {

/// The records with white noise of policy::kResolution on their outputs, the same each time.
std::vector<MappedRecord> AtResolution(std::vector<MappedRecord> records);

}  // namespace dynoproof::diagnosis
