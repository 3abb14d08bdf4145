#include "trace/mat_matrix.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <limits>
#include <utility>

namespace dynoproof::trace::mat {
namespace {

template <class T>
std::vector<double> Convert(std::span<const char> bytes, bool swapped) {
  std::vector<double> values(bytes.size() / sizeof(T));
  std::array<char, sizeof(T)> one;
  for (std::size_t i = 0; i < values.size(); ++i) {
    std::memcpy(one.data(), bytes.data() + i * sizeof(T), sizeof(T));
    if (swapped) std::ranges::reverse(one);
    T value;
    std::memcpy(&value, one.data(), sizeof(T));
    values[i] = static_cast<double>(value);
  }
  return values;
}

/// Why the extents make no columns; empty: they do.
std::string WhyNot(const Matrix& matrix) {
  if (!matrix.why_not.empty()) return matrix.why_not;
  if (matrix.name.empty()) return "has no name";
  if (std::ranges::count(matrix.extents, 0U) > 0) return "is empty";
  if (std::ranges::count_if(matrix.extents, [](std::size_t n) { return n > 1; }) > 2)
    return "has more than two dimensions: save its pages as variables of their own";
  return "";
}

}  // namespace

std::optional<std::size_t> Count(std::span<const std::size_t> extents) {
  std::size_t count = 1;
  for (const std::size_t extent : extents) {
    if (extent != 0 && count > std::numeric_limits<std::size_t>::max() / 2 / extent) return {};
    count *= extent;
  }
  return count;
}

void AddColumns(Matrix matrix, Record& record) {
  if (std::string why = WhyNot(matrix); !why.empty()) {
    record.left_out.emplace_back(std::move(matrix.name), std::move(why));
    return;
  }
  std::erase(matrix.extents, 1U);
  const std::size_t rows = matrix.extents.empty() ? 1 : matrix.extents[0];
  const std::size_t columns = matrix.extents.size() < 2 ? 1 : matrix.extents[1];
  if (columns == 1) {
    record.columns.push_back({.name = std::move(matrix.name), .values = std::move(matrix.values)});
    return;
  }
  // Signals are longer than many: a matrix that is wider than high has one in each row.
  const bool by_rows = columns > rows;
  const std::size_t signals = by_rows ? rows : columns, samples = by_rows ? columns : rows;
  if (by_rows)
    record.notes.push_back(fmt::format(
        "variable \"{0}\" is {1} x {2}: its rows are the columns \"{0}[0]\" to \"{0}[{3}]\", of {2} samples each",
        matrix.name, rows, columns, rows - 1));
  for (std::size_t j = 0; j < signals; ++j) {
    Column column{.name = fmt::format("{}[{}]", matrix.name, j)};
    column.values.reserve(samples);
    for (std::size_t i = 0; i < samples; ++i)
      column.values.push_back(matrix.values[by_rows ? j + i * rows : j * rows + i]);
    record.columns.push_back(std::move(column));
  }
}

std::uint32_t Word(const char* bytes, bool swapped) {
  std::uint32_t word = 0;
  std::memcpy(&word, bytes, sizeof word);
  return swapped ? __builtin_bswap32(word) : word;
}

std::size_t SizeOf(Number number) {
  constexpr std::size_t kSizes[] = {1, 1, 2, 2, 4, 4, 8, 8, 4, 8};
  return kSizes[static_cast<std::size_t>(number)];
}

std::vector<double> ToDoubles(Number number, std::span<const char> bytes, bool swapped) {
  switch (number) {
    case Number::kInt8:
      return Convert<std::int8_t>(bytes, swapped);
    case Number::kUInt8:
      return Convert<std::uint8_t>(bytes, swapped);
    case Number::kInt16:
      return Convert<std::int16_t>(bytes, swapped);
    case Number::kUInt16:
      return Convert<std::uint16_t>(bytes, swapped);
    case Number::kInt32:
      return Convert<std::int32_t>(bytes, swapped);
    case Number::kUInt32:
      return Convert<std::uint32_t>(bytes, swapped);
    case Number::kInt64:
      return Convert<std::int64_t>(bytes, swapped);
    case Number::kUInt64:
      return Convert<std::uint64_t>(bytes, swapped);
    case Number::kSingle:
      return Convert<float>(bytes, swapped);
    case Number::kDouble:
      break;
  }
  return Convert<double>(bytes, swapped);
}

}  // namespace dynoproof::trace::mat
