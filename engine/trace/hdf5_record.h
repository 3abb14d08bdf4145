// Records in HDF5 files: traces of the program, and files of others.
#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "base/status.h"
#include "trace/record.h"

namespace dynoproof::trace {

/// Of a matrix in a file of another layout that nobody asked for by name, at most so many signals are offered.
inline constexpr std::size_t kMostSignalsOfMatrix = 64;

/// Reads a record from an HDF5 file, in a process of its own (hdf5_apart.h). What attributes say about the numbers is
/// applied (hdf5_meaning.h); what the file does not hold is a failure (hdf5_values.h), as is more than kMostBytes.
///
/// Without `datasets`, a file in the layout of trace_io.h gives its times and signals, unchecked. Of any other layout
/// every dataset of numbers with one or two extents above 1 becomes a column, or several. Its name is the last part of
/// its path where no other has it, else the whole path, which is the column's heading and finds it in any case. What
/// cannot be a column is in Record::left_out with the reason: scalars, texts, cubes, matrices of many signals, an unknown
/// scaling, links into other files.
///
/// With `datasets`: these, by path ("/measurement/torque") or by a last part that no other has, each a column named as it
/// was given.
///
/// A matrix [n][m] becomes the columns "path[0]" ... "path[m-1]", of which one may be asked for by that name; where it
/// is wider than high its rows are the signals, which a note says. Extents of 1 do not count. The time of a column is
/// `t` or `time` in the same group, or in the nearest one around it, of equal length; there may be none.
///
/// `scaled_later`: datasets, by path or last part, to which the caller applies a gain and an offset of its own: they are
/// not refused for an attribute such as `gain`, which is not applied here; `scale_factor` and its kin are as ever.
///
/// Failure (exit code 2, `signal` = path): as ReadTrace(); there is no column, or not one that was asked for; then with
/// the names of the datasets that the file does have.
Result<Record> ReadHdf5Record(const std::filesystem::path& path, std::span<const std::string> datasets = {},
                              std::span<const std::string> scaled_later = {});

/// Every dataset of numbers in an HDF5 file, by full path, sorted.
Result<std::vector<std::string>> ListHdf5Datasets(const std::filesystem::path& path);

}  // namespace dynoproof::trace
