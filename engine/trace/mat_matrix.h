// What the readers of the MAT formats have in common: a variable, and how it becomes columns of a record.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "trace/record.h"

namespace dynoproof::trace::mat {

/// One variable of a file.
struct Matrix {
  std::string name;
  std::vector<std::size_t> extents = {};  // rows, columns, pages, ...
  std::vector<double> values = {};        // one column behind the other; of a text (v4 only) the codes of its letters
  std::string why_not = {};               // "is text": why it is no column; empty: it is one
  bool is_text = false;
};

/// What a file holds, or what is wrong with it.
struct Content {
  std::vector<Matrix> matrices = {};
  std::string fault = {};
};

inline constexpr const char* kIsText = "is text";
inline constexpr const char* kIsComplex = "is complex: save real(x), imag(x) or abs(x)";
inline constexpr const char* kIsCell = "is a cell array: save each cell as a variable of its own";
inline constexpr const char* kIsStruct = "is a struct: save its fields as variables, save('file.mat', '-struct', 's')";
inline constexpr const char* kIsSparse = "is sparse: save full(x)";
inline constexpr const char* kIsObject =
    "is a MATLAB object (timetable, table, datetime, string, ...), which only MATLAB can read: save its columns as "
    "variables, t = seconds(tt.Properties.RowTimes); x = tt.x; save('file.mat', 't', 'x'), or export it with "
    "writetimetable(tt, 'file.csv')";

/// The product of extents; nothing if it does not fit into 63 bits.
std::optional<std::size_t> Count(std::span<const std::size_t> extents);

/// Appends the columns of a variable to the record, or an entry of `left_out`.
void AddColumns(Matrix matrix, Record& record);

/// A whole number of a file, in its byte order.
std::uint32_t Word(const char* bytes, bool swapped);

/// The types that numbers are stored in, in any of the formats.
enum class Number { kInt8, kUInt8, kInt16, kUInt16, kInt32, kUInt32, kInt64, kUInt64, kSingle, kDouble };
std::size_t SizeOf(Number number);
/// The numbers of `bytes`, which holds a whole count of them.
std::vector<double> ToDoubles(Number number, std::span<const char> bytes, bool swapped);

}  // namespace dynoproof::trace::mat
