// Measured data as text: reading what loggers and spreadsheets write.
#pragma once

#include <cstddef>
#include <filesystem>

#include "base/status.h"
#include "trace/record.h"

namespace dynoproof::trace {

/// Reads a text file of columns, line by line (a pipe will do; memory holds the numbers only).
///
/// - Names: the row of words with as many cells as the rows of numbers below it. What stands before it is skipped, with
///   a note. `#` opens a comment line; a comment right above the numbers gives the names if nothing else does. Empty
///   lines may stand anywhere.
/// - Units: the row below the names if no cell of it is a number but a plain `1` (dimensionless, as is `-`), and a cell
///   in a column of numbers is a unit (base/units.h) or in square brackets. A row that merely cannot be read is never
///   taken for one. A name may hold its unit instead: `time [ms]`, `time (ms)`, `T_shaft/Nm`; Record::Find knows such a
///   column by its name and by its whole heading.
/// - Separators: `;`, tab, comma, blanks or two blanks, whichever makes the most of the first lines numbers; `sep=;` in the first
///   line decides. One may end every line. Blanks around cells do not count, and cells may be quoted ("" inside quotes
///   is one quote).
/// - The decimal mark is one for the whole file, point or comma; the first lines decide. A cell with the other mark is
///   no number. There are no marks between thousands; "1,234" alone is read as 1.234 only between semicolons. The
///   exponent may be e, E, d or D.
/// - Line ends are LF, CRLF, CR CR LF or CR. Text that is not UTF-8 is taken as Windows-1252, with a note.
/// - LabVIEW measurement files (.lvm) are read by their own header (trace/lvm.h).
///
/// Nothing is invented, and only what is used can be at fault. Empty cells, `nan` and `inf` are kept as they are (empty:
/// NaN) and reported in Record::non_finite, with the line. Cells that are no numbers are NaN as well, with a note that
/// names the first of a column, if most of the column are numbers. Columns of words, without a name, without any value
/// or with a name that is there twice go to Record::left_out, and a note says so.
///
/// A last line without a line end is taken unless its last number may be cut (trace/csv_cut.h): then the row is left
/// out, with a note. Rows without any value are left out as well where the time column tells that they are missing, and
/// at the end; so are lines of words behind the rows.
///
/// The column `t` or `time` is the time column; a record without one has none (its rate must be known elsewhere).
///
/// Failure (exit code 2, `signal` = path): cannot be read; neither a regular file nor a pipe; grows while it is read;
/// more than kMostPipeBytes in a pipe; binary or UTF-16; no row of names, no data, no column of numbers; the time column
/// twice; a row with too few or too many cells or a wrong quote: up to kMostBadRows of them with their lines, then the
/// number of the others.
///
/// `skip`: so many lines are passed over first, unread.
Result<Record> ReadCsv(const std::filesystem::path& path, int skip = 0);

inline constexpr std::size_t kMostBadRows = 20;
inline constexpr std::size_t kMostPipeBytes = std::size_t{1} << 30;

}  // namespace dynoproof::trace
