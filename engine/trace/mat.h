// Measured data in MATLAB's own files: MAT v4, v5 (v6, v7) and v7.3, read through libmatio.
#pragma once

#include <filesystem>

#include "base/status.h"
#include "trace/record.h"

namespace dynoproof::trace {

/// Every real, full variable of numbers becomes a column under its name; a matrix [n][m] becomes "name[0]" ...
/// "name[m-1]", its columns; a row vector counts as one column. There are no units. What cannot be one (complex,
/// sparse, text, cell, struct, objects such as a timetable, empty, more than two dimensions) is left out, with the
/// reason and the way to export it in Record::left_out.
///
/// Failure (exit code 2, `signal` = path): cannot be read, is no MAT file, is damaged or cut short, or has no column.
Result<Record> ReadMat(const std::filesystem::path& path);

}  // namespace dynoproof::trace
