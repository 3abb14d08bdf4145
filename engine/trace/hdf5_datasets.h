// The datasets of an HDF5 file as columns of a record, whatever its layout. In this process: hdf5_record.h puts one
// between.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "base/status.h"
#include "trace/hdf5.h"
#include "trace/record.h"

namespace dynoproof::trace {

/// Everything in a file, by full path, sorted: datasets, and links that lead out of it.
struct Listing {
  std::vector<std::string> datasets;
  std::vector<std::pair<std::string, std::string>> links_out;  // path, file
};
Result<Listing> ListAll(hid_t file);

/// The columns of a record by the names asked for, or of all datasets where none are. See ReadHdf5Record().
Result<Record> ReadDatasets(hid_t file, std::span<const std::string> wanted, std::span<const std::string> scaled_later);

}  // namespace dynoproof::trace
