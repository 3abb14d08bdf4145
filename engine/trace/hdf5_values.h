// The numbers of a dataset, and only those that the file really holds.
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

#include "base/status.h"
#include "trace/hdf5.h"
#include "trace/hdf5_apart.h"

namespace dynoproof::trace::hdf5 {

/// The most that the numbers read from one file may take as doubles, together. A few kilobytes of deflated zeros
/// unpack to gigabytes; a record of 24 h at 1 kHz takes 0.7 GB a signal.
inline constexpr std::size_t kMostBytes = std::size_t{2} << 30;

/// What the process that reads this file may take: time enough to unpack all that may be read.
ApartLimits LimitsFor(const std::filesystem::path& path);

/// Whether a type of numbers is one that programs write. The description of a type has no checksum in older files: a
/// changed bit in it would give other numbers, not an error.
bool IsUsual(hid_t type);
/// Whether a dataset holds integer or floating-point numbers.
bool HoldsNumbers(hid_t dataset);

/// All numbers of a dataset, row by row. Integer and floating-point types of any width are converted. HDF5 fills what
/// a file does not hold with zeros and reads from other files without a word, so that these are failures here: no
/// numbers; a type that is none of the usual ones; more than kMostBytes; extents that differ from what is stored or pass
/// their own maximum;
/// chunks that are missing, stand outside the file or twice at one place; values in another file (external, virtual); a
/// checksum that does not hold. Of damage within the values of a dataset without checksum nobody can know.
Result<std::vector<double>> ReadDoubles(hid_t dataset, const std::string& name);

}  // namespace dynoproof::trace::hdf5
