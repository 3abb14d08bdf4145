// Records in HDF5 files: traces of the program, and files of others.
#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "base/status.h"
#include "trace/record.h"

namespace dynoproof::trace {

/// Reads a record from an HDF5 file. Without `datasets`: the layout of trace_io.h, times and values unchecked. With
/// `datasets`: these, by path ("/measurement/torque"), each a column named as the path was given. A matrix [n][m]
/// becomes the columns "path[0]" ... "path[m-1]", of which one may be asked for by that name; extents of 1 do not
/// count. The unit is the attribute `unit` or `units`. Failure (exit code 2, `signal` = path): as ReadTrace(), with the
/// names of the datasets that the file does have.
Result<Record> ReadHdf5Record(const std::filesystem::path& path, std::span<const std::string> datasets = {});

/// Every dataset of numbers in an HDF5 file, by full path, sorted.
Result<std::vector<std::string>> ListHdf5Datasets(const std::filesystem::path& path);

}  // namespace dynoproof::trace
