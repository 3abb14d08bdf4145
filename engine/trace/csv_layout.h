// How a text record is laid out, found from its first lines.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "trace/csv_heading.h"

namespace dynoproof::trace::csv {

/// A line that is not empty, as UTF-8.
struct HeadLine {
  std::size_t number = 0;  // from 1
  std::string text;
};

/// Evenly spaced times that the file states instead of a column.
struct Raster {
  double start = 0.0, step = 0.0;
};

struct Layout {
  std::string fault;  // one sentence; the rest is then void
  char separator = ',';
  char mark = 0;               // decimal mark; 0 where the first lines have none
  bool comma_allowed = false;  // as decimal mark, while none is known
  std::vector<Heading> columns;
  std::size_t names_line = 0;       // number of the line of names
  std::size_t first_row = 0;        // place in the head of the first row of data
  std::optional<Raster> raster;     // of the first column
  std::optional<std::size_t> time;  // the column of times, if the format says so
  bool spare_cells = false;         // a row may have further cells, which are comments
  std::vector<std::string> notes;
};

/// Lines looked at: a preamble may be that long. A block that names at most so many bytes, and kFewestHeadLines.
inline constexpr std::size_t kMostHeadLines = 500, kFewestHeadLines = 20, kHeadBytes = 256 * 1024;

/// Finds names, units, separator and decimal mark (rules: csv.h).
///
/// For each separator and number of cells that rows of numbers have, the table is: the first row of which most cells
/// in columns of numbers are numbers, and before it a row of names, with as many cells and no number. The table whose
/// rows hold the greatest part of numbers wins; `;`, tab, `,`, blanks in this order where they are alike.
Layout FindLayout(const std::vector<HeadLine>& head);

}  // namespace dynoproof::trace::csv
