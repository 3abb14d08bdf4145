// What `compare` reads: traces, and what other programs write, in one form.
#pragma once

#include <string>
#include <vector>

#include "base/status.h"
#include "trace/trace.h"

namespace dynoproof {

/// A trace (HDF5), or a record with time stamps (CSV, MAT) as one: every column is a signal with the unit that stands in
/// the file, linear between its samples, its nominal not known. Rows at one instant are a jump: simulators write the
/// values before and after an event. They are kept in their order, the next double apart (score::IsJump). `notes` takes
/// what a reader should know. Failure (exit code 2): as the readers say it; a column without time stamps, time that
/// falls or is not finite, a time in a unit of another quantity, and all that trace::Validate() says.
Result<trace::Trace> ReadComparable(const std::string& file, std::vector<std::string>& notes);

}  // namespace dynoproof
