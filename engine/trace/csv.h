// Measured data as text: reading what loggers and spreadsheets write, and writing it back.
#pragma once

#include <cstddef>
#include <filesystem>
#include <span>
#include <string_view>

#include "base/status.h"
#include "trace/record.h"

namespace dynoproof::trace {

/// Reads a text file of columns, line by line (a pipe will do; memory holds the numbers only).
///
/// - First a row of names, each once; they may be quoted ("" inside quotes is one quote). `#` opens a comment line;
///   comment lines and empty lines may stand anywhere.
/// - A second row is one of units if some cell of it is no number and those that are numbers are a plain `1`
///   (dimensionless, as is `-`). Brackets around a unit are dropped.
/// - The separator is `;` if the row of names has one outside quotes, else the tab, else the comma.
/// - The decimal mark is the point; with `;` or tab it may be the comma. The first cell that has a mark decides, the
/// other
///   mark is a fault from there on. There are no marks between thousands.
/// - Line ends are LF or CRLF; a UTF-8 byte order mark is skipped. A separator may end every line.
/// - Empty cells, `nan` and `inf` are kept as they are (empty: NaN) and reported in Record::non_finite, with the line.
///
/// The column `t` or `time` is the time column; a record without one has none (its rate must be known elsewhere).
///
/// Failure (exit code 2, `signal` = path): cannot be read, binary or UTF-16, no row of names, names empty or twice, no
/// data, or bad cells: up to kMostBadCells of them with line and column, then the number of the others.
Result<Record> ReadCsv(const std::filesystem::path& path);

inline constexpr std::size_t kMostBadCells = 20;

/// Writes columns of equal length: names, units (if any column has one; "1" becomes "-"), then the shortest decimals
/// that read back as the same doubles. Whole or not at all (base/atomic_file.h). Failure (exit code 3): lengths differ,
/// no columns, names empty or twice, or the file cannot be written.
Status WriteCsv(const std::filesystem::path& path, std::span<const Column> columns, char separator = ',');

}  // namespace dynoproof::trace
