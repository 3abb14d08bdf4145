#include "trace/mat.h"

#include <fmt/format.h>
#include <matio.h>

#include <algorithm>
#include <bit>
#include <cstdint>
#include <cstring>
#include <fstream>
#include <memory>

#include "trace/hdf5.h"

namespace dynoproof::trace {
namespace {

Failure Bad(const std::filesystem::path& path, std::string message) {
  return {.message = std::move(message), .signal = path.string(), .time_s = {}, .exit_code = 2};
}

constexpr const char* kDamaged = "is damaged or cut short: ";

/// A whole number of the file, in its byte order.
std::uint32_t Word(const char* bytes, bool swapped) {
  std::uint32_t word = 0;
  std::memcpy(&word, bytes, sizeof word);
  return swapped ? __builtin_bswap32(word) : word;
}

/// The elements of a v5 file follow each other, each with its length: libmatio reads past the end of one that was cut
/// and takes what it finds there for numbers.
std::string FaultOf5(std::ifstream& file, std::uint64_t size) {
  constexpr std::uint64_t kHeader = 128, kTag = 8;
  char header[kHeader];
  file.seekg(0);
  if (!file.read(header, kHeader)) return "its header is not whole";
  const bool swapped = header[126] == 'M';
  std::uint64_t at = kHeader;
  while (at < size) {
    char tag[kTag];
    file.seekg(static_cast<std::streamoff>(at));
    if (size - at < kTag || !file.read(tag, kTag)) return fmt::format("the element at byte {} has no whole tag", at);
    const std::uint64_t length = Word(tag + 4, swapped);
    if (length > size - at - kTag)
      return fmt::format("the element at byte {} has {} bytes, of which {} are there", at, length, size - at - kTag);
    at += kTag + length;
  }
  return "";
}

/// The same for v4: matrix after matrix, each with its extents.
std::string FaultOf4(std::ifstream& file, std::uint64_t size) {
  constexpr std::uint64_t kHeader = 20;
  std::uint64_t at = 0;
  while (at < size) {
    char header[kHeader];
    file.seekg(static_cast<std::streamoff>(at));
    if (size - at < kHeader || !file.read(header, kHeader))
      return fmt::format("the matrix at byte {} has no whole header", at);
    const bool swapped = Word(header, false) > 5000;  // type = 1000 M + 100 O + 10 P + T
    const std::uint32_t type = Word(header, swapped);
    const std::uint64_t rows = Word(header + 4, swapped), columns = Word(header + 8, swapped);
    const std::uint64_t parts = Word(header + 12, swapped) == 1 ? 2 : 1, name = Word(header + 16, swapped);
    constexpr std::uint64_t kBytes[] = {8, 4, 4, 2, 2, 1};
    const std::uint32_t precision = type / 10 % 10;
    if (type > 5000 || precision > 5) return fmt::format("the matrix at byte {} has an unknown type ({})", at, type);
    if (rows > size || columns > size || name > size) return fmt::format("the matrix at byte {} cannot be in it", at);
    const std::uint64_t length = name + rows * columns * parts * kBytes[precision];
    if (length > size - at - kHeader)
      return fmt::format("the matrix at byte {} has {} bytes, of which {} are there", at, length, size - at - kHeader);
    at += kHeader + length;
  }
  return "";
}

/// Why a variable is no column; empty: it is one.
std::string WhyNot(const matvar_t& variable) {
  switch (variable.class_type) {
    case MAT_C_CELL:
      return "is a cell array: save each cell as a variable of its own";
    case MAT_C_STRUCT:
      return "is a struct: save its fields as variables, save('file.mat', '-struct', 's')";
    case MAT_C_CHAR:
      return "is text";
    case MAT_C_SPARSE:
      return "is sparse: save full(x)";
    case MAT_C_OBJECT:
    case MAT_C_OPAQUE:
    case MAT_C_FUNCTION:
      return "is a MATLAB object (timetable, table, datetime, string, ...), which only MATLAB can read: save its "
             "columns "
             "as variables, t = seconds(tt.Properties.RowTimes); x = tt.x; save('file.mat', 't', 'x'), or export it "
             "with "
             "writetimetable(tt, 'file.csv')";
    default:
      break;
  }
  if (variable.isComplex != 0) return "is complex: save real(x), imag(x) or abs(x)";
  std::size_t count = 1, long_ones = 0;
  for (int i = 0; i < variable.rank; ++i) {
    count *= variable.dims[i];
    if (variable.dims[i] > 1) ++long_ones;
  }
  if (variable.rank < 1 || count == 0 || variable.class_type == MAT_C_EMPTY) return "is empty";
  if (long_ones > 2) return "has more than two dimensions: save its pages as variables of their own";
  return "";
}

/// Which entries of a variable make a column: in the order of the file columns stand one behind the other.
struct Entries {
  std::size_t first, count, stride;
};

template <class T>
void Append(const matvar_t& variable, const Entries& entries, std::vector<double>& values) {
  const T* const data = static_cast<const T*>(variable.data) + entries.first;
  values.resize(entries.count);
  for (std::size_t i = 0; i < entries.count; ++i) values[i] = static_cast<double>(data[i * entries.stride]);
}

bool Read(const matvar_t& variable, const Entries& entries, std::vector<double>& values) {
  switch (variable.class_type) {
    case MAT_C_DOUBLE:
      return Append<double>(variable, entries, values), true;
    case MAT_C_SINGLE:
      return Append<float>(variable, entries, values), true;
    case MAT_C_INT8:
      return Append<std::int8_t>(variable, entries, values), true;
    case MAT_C_UINT8:
      return Append<std::uint8_t>(variable, entries, values), true;
    case MAT_C_INT16:
      return Append<std::int16_t>(variable, entries, values), true;
    case MAT_C_UINT16:
      return Append<std::uint16_t>(variable, entries, values), true;
    case MAT_C_INT32:
      return Append<std::int32_t>(variable, entries, values), true;
    case MAT_C_UINT32:
      return Append<std::uint32_t>(variable, entries, values), true;
    case MAT_C_INT64:
      return Append<std::int64_t>(variable, entries, values), true;
    case MAT_C_UINT64:
      return Append<std::uint64_t>(variable, entries, values), true;
    default:
      return false;
  }
}

using File = std::unique_ptr<mat_t, decltype(&Mat_Close)>;
using Variable = std::unique_ptr<matvar_t, decltype(&Mat_VarFree)>;

/// Appends the columns of a variable; an explanation where it cannot be read.
std::string Take(mat_t* file, matvar_t& variable, Record& record) {
  const std::string name = variable.name;
  if (Mat_VarReadDataAll(file, &variable) != 0 || variable.data == nullptr) return "its data cannot be read";
  std::vector<std::size_t> extents(variable.dims, variable.dims + variable.rank);
  std::erase(extents, 1U);
  const std::size_t rows = extents.empty() ? 1 : extents[0], columns = extents.size() < 2 ? 1 : extents[1];
  if (variable.nbytes < rows * columns * Mat_SizeOfClass(variable.class_type)) return "its data are not whole";
  // Signals are longer than many: a matrix that is wider than high has one in each row.
  const bool by_rows = columns > rows && rows > 1;
  const std::size_t signals = by_rows ? rows : columns, samples = by_rows ? columns : rows;
  if (by_rows)
    record.notes.push_back(fmt::format(
        "variable \"{0}\" is {1} x {2}: its rows are the columns \"{0}[0]\" to \"{0}[{3}]\", of {2} samples each", name,
        rows, columns, rows - 1));
  for (std::size_t j = 0; j < signals; ++j) {
    Column column{.name = signals == 1 ? name : fmt::format("{}[{}]", name, j)};
    if (!Read(variable, by_rows ? Entries{j, samples, rows} : Entries{j * rows, samples, 1}, column.values))
      return "its numbers are of an unknown type";
    record.columns.push_back(std::move(column));
  }
  return "";
}

}  // namespace

Result<Record> ReadMat(const std::filesystem::path& path) {
  std::ifstream stream(path, std::ios::binary | std::ios::ate);
  if (!stream) return Bad(path, "cannot be read");
  const auto size = static_cast<std::uint64_t>(stream.tellg());
  if (size == 0) return Bad(path, "is empty");
  const hdf5::Session session;  // v7.3 is HDF5, whose library would write its complaints to the terminal
  const File file(Mat_Open(path.string().c_str(), MAT_ACC_RDONLY), &Mat_Close);
  if (file == nullptr) return Bad(path, "is no MAT file, or damaged from its first bytes on");
  const mat_ft version = Mat_GetVersion(file.get());
  const std::string fault = version == MAT_FT_MAT4   ? FaultOf4(stream, size)
                            : version == MAT_FT_MAT5 ? FaultOf5(stream, size)
                                                     : "";
  if (!fault.empty()) return Bad(path, kDamaged + fault);
  Record record;
  record.source = path.string();
  for (;;) {
    const Variable variable(Mat_VarReadNextInfo(file.get()), &Mat_VarFree);
    if (variable == nullptr) break;
    const std::string name = variable->name != nullptr ? variable->name : "";
    std::string why = WhyNot(*variable);
    if (why.empty() && name.empty()) why = "has no name";
    if (!why.empty()) {
      record.left_out.emplace_back(name, std::move(why));
    } else if (const std::string broken = Take(file.get(), *variable, record); !broken.empty()) {
      return Bad(path, fmt::format("{}variable \"{}\": {}", kDamaged, name, broken));
    }
  }
  if (record.columns.empty()) {
    std::string message = record.left_out.empty() ? "holds no variables: it is damaged, or was never filled"
                                                  : "holds no variable that can be a column";
    for (const auto& [name, why] : record.left_out) message += fmt::format("\nvariable \"{}\" {}", name, why);
    return Bad(path, message);
  }
  FinishRecord(record);
  return record;
}

}  // namespace dynoproof::trace
