#include "trace/mat73.h"

#include <fmt/format.h>

#include <algorithm>
#include <fstream>
#include <string>
#include <string_view>
#include <utility>

#include "base/bad_input.h"
#include "trace/hdf5.h"
#include "trace/hdf5_apart.h"
#include "trace/hdf5_attributes.h"
#include "trace/hdf5_meaning.h"
#include "trace/hdf5_values.h"

namespace dynoproof::trace::mat {

template <class Archive>
void Members(Archive& archive, Matrix& matrix) {
  Pass(archive, matrix.name);
  Pass(archive, matrix.extents);
  Pass(archive, matrix.values);
  Pass(archive, matrix.why_not);
  Pass(archive, matrix.is_text);
}

namespace {

using hdf5::Handle;

/// The text of an attribute; "" where there is none. Failure: it is no text.
Result<std::string> TextOf(hid_t object, const std::string& name) {
  const Result<hdf5::Attribute> value = hdf5::ReadAttribute(object, name);
  if (!value.ok()) return value.failure();
  if (std::holds_alternative<std::monostate>(*value)) return std::string();
  const auto* const text = std::get_if<std::string>(&*value);
  if (text == nullptr) return BadInput(fmt::format("attribute \"{}\" is not one text", name));
  return *text;
}

bool Has(hid_t object, const char* attribute) { return H5Aexists(object, attribute) > 0; }

/// The order of bytes that the text in front of the file says it was written in; H5T_ORDER_NONE where there is no such.
H5T_order_t OrderOf(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  std::string header(128, '\0');
  if (!file.read(header.data(), static_cast<std::streamsize>(header.size()))) return H5T_ORDER_NONE;
  return header.ends_with(std::string_view("\x00\x02IM", 4))   ? H5T_ORDER_LE
         : header.ends_with(std::string_view("\x02\x00MI", 4)) ? H5T_ORDER_BE
                                                               : H5T_ORDER_NONE;
}

/// Whether numbers are stored as their class in MATLAB is. Nothing else in such a file vouches for the description of
/// a type, and a changed bit in it makes whole numbers out of the bits of others.
bool IsOfClass(hid_t type, const std::string& class_name) {
  const bool is_float = H5Tget_class(type) == H5T_FLOAT;
  const std::size_t bits = 8 * H5Tget_size(type);
  if (class_name == "double") return is_float && bits == 64;
  if (class_name == "single") return is_float && bits == 32;
  if (is_float) return false;
  if (class_name == "logical") return bits == 8;  // others than MATLAB write it with a sign
  const bool is_signed = H5Tget_sign(type) == H5T_SGN_2;
  return class_name == fmt::format("{}int{}", is_signed ? "" : "u", bits);
}

/// Why a dataset is no column; "" if it may be one.
Result<std::string> WhyNot(hid_t dataset, H5T_order_t order) {
  const Result<std::string> class_name = TextOf(dataset, "MATLAB_class");
  if (!class_name.ok()) return class_name.failure();
  static constexpr const char* kNumbers[] = {"",      "double", "single", "logical", "int8",  "uint8",
                                             "int16", "uint16", "int32",  "uint32",  "int64", "uint64"};
  if (*class_name == "char") return std::string(kIsText);
  if (*class_name == "cell") return std::string(kIsCell);
  if (*class_name == "struct") return std::string(kIsStruct);
  if (Has(dataset, "MATLAB_object_decode") || std::ranges::count(kNumbers, *class_name) == 0)
    return std::string(kIsObject);
  if (Has(dataset, "MATLAB_empty")) {
    const Result<hdf5::Attribute> empty = hdf5::ReadAttribute(dataset, "MATLAB_empty");
    if (!empty.ok()) return empty.failure();
    const auto* const value = std::get_if<std::int64_t>(&*empty);
    if (value == nullptr) return BadInput("attribute \"MATLAB_empty\" is not one whole number");
    if (*value != 0) return std::string("is empty");
  }
  const Handle type(H5Dget_type(dataset));
  switch (H5Tget_class(type.id())) {
    case H5T_INTEGER:
    case H5T_FLOAT:
      if (!class_name->empty() && !IsOfClass(type.id(), *class_name))
        return BadInput(fmt::format("its numbers are not stored as the class \"{}\" is, which it names", *class_name));
      if (order != H5T_ORDER_NONE && H5Tget_size(type.id()) > 1 && H5Tget_order(type.id()) != order)
        return BadInput("its numbers are not in the order of bytes that the head of the file names");
      return std::string();
    case H5T_STRING:
      return std::string(kIsText);
    case H5T_REFERENCE:
      return std::string(kIsCell);
    case H5T_COMPOUND:
      return std::string(H5Tget_nmembers(type.id()) == 2 && H5Tget_member_index(type.id(), "real") >= 0
                             ? kIsComplex
                             : "is a table of rows with fields: save each field as a variable of its own");
    default:
      return std::string("does not hold numbers");
  }
}

Result<Matrix> ReadDataset(hid_t file, H5T_order_t order, const std::string& name, std::size_t& values) {
  Matrix matrix{.name = name};
  const Result<Handle> dataset = hdf5::OpenDataset(file, name);
  if (!dataset.ok()) return dataset.failure();
  Result<std::string> why = WhyNot(dataset->id(), order);
  if (!why.ok()) return BadInput(fmt::format("variable \"{}\": {}", name, why.failure().message));
  matrix.why_not = *std::move(why);
  if (!matrix.why_not.empty()) return matrix;
  const Result<hdf5::Space> space = hdf5::SpaceOf(dataset->id(), fmt::format("variable \"{}\"", name));
  if (!space.ok()) return space.failure();
  // Nobody writes such a variable, and nothing else in the file vouches for its extents.
  if (space->may_grow_to_a_limit)
    return BadInput(fmt::format("variable \"{}\" has extents {}, which are not those that it was given", name,
                                fmt::join(space->shape, " x ")));
  matrix.extents = space->shape;
  std::ranges::reverse(matrix.extents);
  if (std::ranges::count_if(matrix.extents, [](std::size_t n) { return n > 1; }) > 2) return matrix;  // never a column
  values += std::min(space->count, hdf5::kMostBytes);
  if (values > hdf5::kMostBytes / sizeof(double))
    return BadInput(fmt::format("variable \"{}\" is the one with which there are more than {} values", name,
                                hdf5::kMostBytes / sizeof(double)));
  const Result<hdf5::Meaning> meaning = hdf5::ReadMeaning(dataset->id(), name);
  if (!meaning.ok()) return meaning.failure();
  Result<std::vector<double>> read = hdf5::ReadMeasured(dataset->id(), name, *meaning);
  if (!read.ok()) return read.failure();
  matrix.values = *std::move(read);
  return matrix;
}

Result<std::vector<Matrix>> ReadAll(hid_t file, H5T_order_t order) {
  const Result<Handle> root = hdf5::OpenGroup(file, "/");
  if (!root.ok()) return root.failure();
  const Result<std::vector<std::string>> names = hdf5::LinkNames(root->id());
  if (!names.ok()) return names.failure();
  std::vector<Matrix> matrices;
  std::size_t values = 0;
  for (const std::string& name : *names) {
    if (name.starts_with('#')) continue;  // where MATLAB keeps what cells and objects point to
    switch (hdf5::KindOf(file, name)) {
      case hdf5::Kind::kGroup: {
        const Result<Handle> group = hdf5::OpenGroup(file, name);
        if (!group.ok()) return group.failure();
        matrices.push_back({.name = name, .why_not = Has(group->id(), "MATLAB_sparse") ? kIsSparse : kIsStruct});
        break;
      }
      case hdf5::Kind::kOther:
        matrices.push_back({.name = name, .why_not = "is no variable"});
        break;
      default: {
        Result<Matrix> matrix = ReadDataset(file, order, name, values);
        if (!matrix.ok()) return matrix.failure();
        matrices.push_back(*std::move(matrix));
      }
    }
  }
  return matrices;
}

}  // namespace

Result<std::vector<Matrix>> ReadMat73(const std::filesystem::path& path) {
  const hdf5::Session session;
  return ReadApart<std::vector<Matrix>>(hdf5::LimitsFor(path), [&]() -> Result<std::vector<Matrix>> {
    hdf5::StayInFile();
    const Result<Handle> file = hdf5::OpenFile(path.string());
    if (!file.ok()) return file.failure();
    return ReadAll(file->id(), OrderOf(path));
  });
}

}  // namespace dynoproof::trace::mat
