// The texts and attributes of an HDF5 file.
#pragma once

#include <cstdint>
#include <string>
#include <variant>
#include <vector>

#include "base/status.h"
#include "trace/hdf5.h"

namespace dynoproof::trace::hdf5 {

/// The text in a scalar string dataset. Texts of variable length are read in a process of their own.
Result<std::string> ReadText(hid_t dataset, const std::string& name);

/// An attribute: nothing if it is missing or of a kind not used here (compound, array, ...).
using Attribute = std::variant<std::monostate, std::string, double, std::int64_t>;
Result<Attribute> ReadAttribute(hid_t object, const std::string& name);
/// The numbers in an attribute that exists, one or many; none if it holds no numbers.
Result<std::vector<double>> ReadNumbers(hid_t object, const std::string& name);

}  // namespace dynoproof::trace::hdf5
