// Where in the first lines of a text record the table is, if one separator parts its cells.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "trace/csv_layout.h"

namespace dynoproof::trace::csv {

/// A line taken apart by one separator. A comment is too: names behind its mark are of use where there are no others.
struct Row {
  Row(const HeadLine& line, char separator);

  /// Whether it has so many cells, not counting one after a separator at the end.
  bool Fits(std::size_t width) const {
    return cells.size() == width || (cells.size() == width + 1 && cells.back().empty());
  }

  std::vector<std::string> cells;  // none: a quote is wrong
  std::vector<bool> numbers;
  bool any_number = false, any_word = false, comment = false;
};

bool IsComment(const HeadLine& line);

/// One reading of the head: places of rows in it.
struct Table {
  char separator = ',';
  std::size_t width = 0, names = 0, first = 0;
  std::optional<std::size_t> units = {};
  double share = 0.0;  // of numbers among the cells that hold something
};

/// Reads the head by one separator.
class Reading {
 public:
  Reading(const std::vector<HeadLine>& head, char separator);

  const std::vector<Row>& rows() const { return rows_; }

  /// Numbers of cells that rows of numbers have, the commonest first, then the smaller.
  std::vector<std::size_t> Widths() const;

  /// The table whose rows have so many cells; nothing without a row of names.
  std::optional<Table> Find(std::size_t width);

 private:
  void FindNumericColumns(std::size_t width);
  bool IsData(const Row& row, std::size_t width) const;
  bool IsUnits(const Row& row, std::size_t width, const Row* names) const;
  bool FindHeads(std::size_t data, Table& table) const;
  double ShareOfNumbers(const Table& table) const;

  char separator_;
  std::vector<Row> rows_;
  std::vector<bool> numeric_;  // of the width asked for last: columns of which most cells are numbers
};

}  // namespace dynoproof::trace::csv
