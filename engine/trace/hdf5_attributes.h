// The texts and attributes of an HDF5 file.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <variant>
#include <vector>

#include "base/status.h"
#include "trace/hdf5.h"

namespace dynoproof::trace::hdf5 {

/// The text in a scalar string dataset. Texts of variable length are read in a process of their own.
Result<std::string> ReadText(hid_t dataset, const std::string& name);

/// An attribute that is there, but no single text or number: several, none, or of another kind.
struct Other {
  std::size_t count = 0;  // of its values, of whatever kind
  bool operator==(const Other&) const = default;
};
/// An attribute: nothing if it is missing. Whoever takes it for an instruction refuses what is Other: to pass that over
/// would be to read the numbers as if nobody had said anything.
using Attribute = std::variant<std::monostate, std::string, double, std::int64_t, Other>;
Result<Attribute> ReadAttribute(hid_t object, const std::string& name);
/// The numbers in an attribute that exists, one or many; none if it holds no numbers.
Result<std::vector<double>> ReadNumbers(hid_t object, const std::string& name);

}  // namespace dynoproof::trace::hdf5
