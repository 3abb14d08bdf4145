// Faults of a sensor that the values of one column show: a converter at its end, a code in place of a value, a value that
// stands still.
#pragma once

#include <vector>

#include "diagnosis/data_check.h"

namespace dynoproof::diagnosis {

/// Adds what is to be known about a column of finite, not constant values; `time`: its stamps, or null.
void CheckValues(const trace::Column& column, const std::vector<double>* time, std::vector<Finding>& findings);

}  // namespace dynoproof::diagnosis
