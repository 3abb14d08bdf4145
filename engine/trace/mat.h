// Measured data and results of simulators in MATLAB's own files: MAT v4, v5 (v6, v7) and v7.3.
#pragma once

#include <filesystem>

#include "base/status.h"
#include "trace/record.h"

namespace dynoproof::trace {

/// Every real, full variable of numbers becomes a column under its name; a matrix [n][m] becomes "name[0]" ...
/// "name[m-1]", its columns, or its rows where it is wider than high; a row vector counts as one column. There are no
/// units. What cannot be one (complex, sparse, text, cell, struct, objects such as a timetable, empty, more than two
/// dimensions) is left out, with the reason and the way to export it in Record::left_out. The results of Modelica
/// simulators, which are MAT v4 files, are read by the names of their variables: see mat_result.h.
///
/// Of what was damaged nothing is read: extents, lengths and types are held against each other and against the bytes
/// that are there (mat4.h, mat5.h), compressed variables carry a checksum, and v7.3 is read as HDF5 is. What no reader
/// can see is a changed bit within the plain numbers of v4 and of uncompressed v5, which have no checksum.
///
/// Failure (exit code 2, `signal` = path): cannot be read, is no MAT file, is damaged or cut short, or has no column.
Result<Record> ReadMat(const std::filesystem::path& path);

}  // namespace dynoproof::trace
