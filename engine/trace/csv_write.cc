#include "trace/csv_write.h"

#include <fmt/format.h>

#include <iterator>
#include <set>
#include <string>

#include "base/atomic_file.h"
#include "trace/csv_text.h"

namespace dynoproof::trace {
namespace {

/// A name or unit as a cell, quoted where it would not read back otherwise.
std::string Quote(const std::string& text, char separator) {
  const bool plain = text.find_first_of(std::string{separator, '"', ';', ',', '\t'}) == std::string::npos &&
                     !text.starts_with('#') && csv::Trim(text) == text;
  if (plain) return text;
  std::string quoted = "\"";
  for (const char c : text) quoted += c == '"' ? std::string("\"\"") : std::string(1, c);
  return quoted + "\"";
}

}  // namespace

Status WriteCsv(const std::filesystem::path& path, std::span<const Column> columns, char separator) {
  const auto fail = [&](std::string message) {
    return Failure{.message = std::move(message), .signal = path.string(), .time_s = {}, .exit_code = 3};
  };
  if (columns.empty()) return fail("there are no columns to write");
  std::set<std::string> seen;
  bool any_unit = false;
  for (const Column& column : columns) {
    if (column.values.size() != columns[0].values.size()) {
      return fail(fmt::format("column \"{}\" has {} values, column \"{}\" has {}: one table needs equal lengths",
                              column.name, column.values.size(), columns[0].name, columns[0].values.size()));
    }
    if (column.name.empty() || column.name.find_first_of("\r\n") != std::string::npos ||
        !seen.insert(column.name).second) {
      return fail(fmt::format("column name \"{}\" is empty, has a line end, or stands twice", column.name));
    }
    any_unit = any_unit || !column.unit.empty();
  }
  std::string text;
  const auto write_row = [&](const auto& cell) {
    for (std::size_t i = 0; i < columns.size(); ++i) {
      if (i > 0) text += separator;
      cell(columns[i]);
    }
    text += '\n';
  };
  write_row([&](const Column& column) { text += Quote(column.name, separator); });
  if (any_unit) {
    write_row([&](const Column& column) { text += column.unit == "1" ? "-" : Quote(column.unit, separator); });
  }
  for (std::size_t row = 0; row < columns[0].values.size(); ++row) {
    write_row([&](const Column& column) { fmt::format_to(std::back_inserter(text), "{}", column.values[row]); });
  }
  return WriteFileAtomically(path, text);
}

}  // namespace dynoproof::trace
