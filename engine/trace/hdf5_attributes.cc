#include "trace/hdf5_attributes.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstring>

#include "base/bad_input.h"
#include "trace/hdf5_apart.h"
#include "trace/hdf5_values.h"

namespace dynoproof::trace::hdf5 {
namespace {

/// The text of an H5T_STRING type's raw bytes, without its padding.
std::string Unpad(std::string text, H5T_str_t padding) {
  if (padding == H5T_STR_SPACEPAD) {
    text.resize(text.find_last_not_of(' ') + 1);
  } else {
    text.resize(std::min(text.find('\0'), text.size()));
  }
  return text;
}

constexpr std::size_t kLongestText = std::size_t{64} << 20;

/// How many letters a text of variable length should have; 0 if that cannot be told. The file says so beside the text's
/// place in a heap, and the library tells nobody: it "converts" that to bytes when asked to leave it as it is.
template <class Read>
std::uint32_t LengthOf(hid_t text_type, Read read) {
  constexpr std::size_t kReference = 16;  // length, place of the heap, number in it
  const Handle bytes(H5Tcreate(H5T_OPAQUE, kReference));
  const H5T_conv_t leave = [](hid_t, hid_t, H5T_cdata_t*, std::size_t, std::size_t, std::size_t, void*, void*,
                              hid_t) -> herr_t { return 0; };
  if (H5Tregister(H5T_PERS_SOFT, "leave", text_type, bytes.id(), leave) < 0) return 0;
  unsigned char reference[kReference] = {};
  const bool known = read(bytes.id(), reference) >= 0;
  std::uint32_t length = 0;
  for (int k = 3; k >= 0; --k) length = length << 8 | reference[k];
  H5Tunregister(H5T_PERS_SOFT, "leave", text_type, bytes.id(), leave);
  return known ? length : 0;
}

/// Reads one string through `read(memory_type, buffer)`; fixed or variable length, as `file_type` says.
template <class Read>
Result<std::string> ReadString(hid_t file_type, const std::string& what, Read read) {
  const htri_t variable = H5Tis_variable_str(file_type);
  if (variable < 0) return LastError(what + " cannot be read");
  if (variable == 0) {
    const std::size_t size = H5Tget_size(file_type);
    if (size > kLongestText) return BadInput(fmt::format("{} has a text of {} bytes", what, size));
    std::string text(size, '\0');
    if (read(file_type, text.data()) < 0) return LastError(what + " cannot be read");
    return Unpad(std::move(text), H5Tget_strpad(file_type));
  }
  // These texts lie in heaps without a checksum, in which HDF5 1.10 loses its way: it reads and writes where it must
  // not, or never ends. In a process of its own, so that it cannot touch numbers that were read already.
  Result<std::string> text = ReadApart<std::string>({.cpu_s = 0.5}, [&]() -> Result<std::string> {
    const Handle type(H5Tcopy(H5T_C_S1));
    H5Tset_size(type.id(), H5T_VARIABLE);
    H5Tset_cset(type.id(), H5Tget_cset(file_type));
    char* raw = nullptr;
    if (read(type.id(), &raw) < 0) return LastError(what + " cannot be read");
    const std::string found = raw == nullptr ? std::string() : std::string(raw, ::strnlen(raw, kLongestText));
    // One whose place in the heap the library does not find comes back as zeros.
    if (found.empty() && LengthOf(type.id(), read) > 0)
      return BadInput(what + " has a text that the file does not hold: the file is damaged; write it anew");
    return found;
  });
  if (text.ok()) return text;
  Failure failure = text.failure();
  if (!failure.message.starts_with(what)) failure.message = fmt::format("{}: {}", what, failure.message);
  return failure;
}

}  // namespace

Result<std::string> ReadText(hid_t dataset, const std::string& name) {
  const Handle type(H5Dget_type(dataset));
  const Result<Space> space = SpaceOf(dataset, fmt::format("dataset \"{}\"", name));
  if (!space.ok()) return space.failure();
  if (H5Tget_class(type.id()) != H5T_STRING || !space->shape.empty()) {
    return BadInput(fmt::format("dataset \"{}\" is not one text", name));
  }
  return ReadString(type.id(), fmt::format("dataset \"{}\"", name), [&](hid_t memory_type, void* out) {
    return H5Dread(dataset, memory_type, H5S_ALL, H5S_ALL, H5P_DEFAULT, out);
  });
}

Result<Attribute> ReadAttribute(hid_t object, const std::string& name) {
  const htri_t exists = H5Aexists(object, name.c_str());
  if (exists == 0) return Attribute{};
  const auto broken = [&] { return LastError(fmt::format("attribute \"{}\" cannot be read", name)); };
  const Handle attribute(exists < 0 ? H5I_INVALID_HID : H5Aopen(object, name.c_str(), H5P_DEFAULT));
  if (!attribute.valid()) return broken();
  const Result<Space> space = SpaceOf(attribute.id(), fmt::format("attribute \"{}\"", name));
  if (!space.ok()) return space.failure();
  const Handle type(H5Aget_type(attribute.id()));
  if (!type.valid()) return broken();
  if (space->count != 1) return Attribute(Other{space->count});
  const H5T_class_t type_class = H5Tget_class(type.id());
  if ((type_class == H5T_INTEGER || type_class == H5T_FLOAT) && !IsUsual(type.id()))
    return BadInput(fmt::format("attribute \"{}\" is a number of an unusual form", name));
  switch (type_class) {
    case H5T_STRING: {
      Result<std::string> text =
          ReadString(type.id(), fmt::format("attribute \"{}\"", name),
                     [&](hid_t memory_type, void* out) { return H5Aread(attribute.id(), memory_type, out); });
      if (!text.ok()) return text.failure();
      return Attribute(*std::move(text));
    }
    case H5T_INTEGER: {
      std::int64_t value = 0;
      if (H5Aread(attribute.id(), H5T_NATIVE_INT64, &value) < 0) return broken();
      return Attribute(value);
    }
    case H5T_FLOAT: {
      double value = 0.0;
      if (H5Aread(attribute.id(), H5T_NATIVE_DOUBLE, &value) < 0) return broken();
      return Attribute(value);
    }
    default:
      return Attribute(Other{1});
  }
}

Result<std::vector<double>> ReadNumbers(hid_t object, const std::string& name) {
  const Handle attribute(H5Aopen(object, name.c_str(), H5P_DEFAULT));
  const Result<Space> space = SpaceOf(attribute.id(), fmt::format("attribute \"{}\"", name));
  if (!space.ok()) return space.failure();
  const Handle type(H5Aget_type(attribute.id()));
  const H5T_class_t type_class = H5Tget_class(type.id());
  if (type_class != H5T_INTEGER && type_class != H5T_FLOAT) return std::vector<double>();
  if (!IsUsual(type.id())) return BadInput(fmt::format("attribute \"{}\" holds numbers of an unusual form", name));
  constexpr std::size_t kMost = 1 << 16;  // attributes are short
  if (space->count > kMost) return BadInput(fmt::format("attribute \"{}\" has {} numbers", name, space->count));
  std::vector<double> values(space->count);
  if (!values.empty() && H5Aread(attribute.id(), H5T_NATIVE_DOUBLE, values.data()) < 0)
    return LastError(fmt::format("attribute \"{}\" cannot be read", name));
  return values;
}

}  // namespace dynoproof::trace::hdf5
