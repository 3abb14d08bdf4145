// Reads an open file in the layout of trace_io.h, in this process. For those that have put a process between (hdf5_apart.h).
#pragma once

#include <cstddef>
#include <string>

#include "base/status.h"
#include "trace/hdf5.h"
#include "trace/trace.h"

namespace dynoproof::trace {

/// "/time", "/time_1", ...
std::string TimeBaseName(std::size_t k);

/// Whether the file is laid out so, or was meant to be.
bool HasTraceLayout(hid_t file);

/// The trace in it, as ReadTraceUnchecked() has it. The caller adds the file to a failure.
Result<Trace> ReadTraceFrom(hid_t file);

}  // namespace dynoproof::trace
