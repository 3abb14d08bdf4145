// The columns of a text record while its rows are read, and what becomes of them.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "trace/clock_text.h"
#include "trace/csv_layout.h"
#include "trace/csv_text.h"
#include "trace/record.h"

namespace dynoproof::trace::csv {

class CellColumns {
 public:
  explicit CellColumns(const Layout& layout);

  /// Why the names allow no record: the time is there twice. "" if they do.
  std::string FaultOfNames() const;

  std::size_t width() const { return columns_.size(); }
  std::size_t rows() const { return rows_; }
  void Reserve(std::size_t rows);

  /// Adds a cell to the row that is being read; `line` is its number in the file.
  void Store(std::size_t index, std::string_view cell, std::size_t line);
  /// The row that is being read is whole.
  void KeepRow() { ++rows_; }
  /// Takes back the row that is being read, or, if none is, the last one. `line` is its number in the file.
  void DropRow(std::size_t line);
  /// Rows at the end that were kept and hold nothing.
  void DropEmptyRows(std::size_t count);

  bool has_time() const { return has_time_; }
  /// Whether most cells of the last column are numbers, and its values.
  bool last_is_numeric() const { return columns_.back().words <= columns_.back().numbers; }
  const std::vector<double>& last_values() const { return columns_.back().values; }

  /// Moves the columns of numbers to the record, and tells of the others in its `left_out` and `notes`.
  void MoveTo(Record& record);

 private:
  struct Column {
    std::string unwanted;  // why nobody can ask for it: "has no name"
    std::vector<double> values;
    std::size_t numbers = 0, words = 0;  // cells that hold something
    ClockReader clock;
    std::size_t stamps = 0;          // words that are stamps of a clock, and so stand among the values
    std::size_t first_bad_line = 0;  // line of the first value that is not finite, 0 none
    std::string first_word;          // what is wrong with the first cell that is no number
    std::size_t first_word_line = 0;
    enum class Kind { kNothing, kNumber, kWord, kStamp } last = Kind::kNothing;
  };

  static std::string WhyNot(const Column& column);
  /// Whether every cell that holds something is a stamp of a clock.
  static bool IsClock(const Column& column) {
    return column.stamps > 0 && column.stamps == column.words + column.numbers;
  }
  /// Stamps among numbers or words are none.
  static void ForgetStamps(Column& column);

  const Layout& layout_;
  NumberReader numbers_;
  std::vector<Column> columns_;
  std::size_t rows_ = 0;
  bool has_time_ = false;
  std::string fault_;
};

}  // namespace dynoproof::trace::csv
