#include "trace/csv.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <iterator>
#include <limits>
#include <set>
#include <system_error>

#include "base/atomic_file.h"
#include "trace/csv_text.h"

namespace dynoproof::trace {
namespace {

/// Reads one file. Each step returns false after having set the failure.
class Reader {
 public:
  Reader(int descriptor, std::string source, std::size_t file_bytes) : lines_(descriptor), file_bytes_(file_bytes) {
    record_.source = std::move(source);
  }

  Result<Record> Read() {
    if (!ReadHeader() || !ReadRows()) return Fail(lines_.fault().empty() ? failure_ : lines_.fault());
    if (!lines_.fault().empty()) return Fail(lines_.fault());
    if (bad_count_ > 0) return Fail(BadCells());
    if (record_.columns[0].values.empty()) return Fail("has a row of names, but no data");
    for (std::size_t i = 0; i < first_bad_line_.size(); ++i) {
      if (first_bad_line_[i] > 0) record_.non_finite.push_back({.column = i, .first_line = first_bad_line_[i]});
    }
    FinishRecord(record_);
    return std::move(record_);
  }

 private:
  Failure Fail(std::string message) const {
    return {.message = std::move(message), .signal = record_.source, .time_s = {}, .exit_code = 2};
  }

  std::string BadCells() const {
    std::string text =
        fmt::format("{} bad cell{} or row{}", bad_count_, bad_count_ == 1 ? "" : "s", bad_count_ == 1 ? "" : "s");
    for (const std::string& sentence : bad_) text += "\n" + sentence;
    if (bad_count_ > bad_.size()) text += fmt::format("\nand {} more", bad_count_ - bad_.size());
    return text;
  }

  void Report(const std::string& what) {
    ++bad_count_;
    if (bad_.size() < kMostBadCells) bad_.push_back(fmt::format("line {}{}", lines_.number(), what));
  }

  /// The next line with data, or nothing.
  std::optional<std::string_view> NextRow() {
    while (const std::optional<std::string_view> line = lines_.Next()) {
      const std::string_view text = csv::Trim(*line);
      // With tabs, a line of blanks is a row of empty cells only if it has a separator; with none it is an empty line.
      if (text.empty() && (separator_ != '\t' || line->find('\t') == std::string_view::npos)) continue;
      if (text.starts_with('#')) {
        last_comment_ = lines_.number();
        continue;
      }
      return separator_ == '\t' ? *line : text;
    }
    return {};
  }

  /// All cells of a line; nothing if a quote is wrong.
  std::optional<std::vector<std::string>> Split(std::string_view line) const {
    std::vector<std::string> cells;
    std::string storage;
    for (bool more = true; more;) {
      const auto cell = csv::TakeCell(line, separator_, storage, more);
      if (!cell) return {};
      cells.emplace_back(*cell);
    }
    return cells;
  }

  bool ReadHeader() {
    const std::optional<std::string_view> line = NextRow();
    if (!line) return SetFailure("is empty: expected a row of names and rows of numbers");
    separator_ = csv::FindSeparator(*line);
    std::optional<std::vector<std::string>> names = Split(*line);
    if (!names) return SetFailure(fmt::format("line {}: a quote is not closed, or text follows it", lines_.number()));
    if (names->size() > 1 && names->back().empty()) names->pop_back();
    csv::NumberReader numbers(separator_ != ',');
    if (std::ranges::all_of(*names, [&](const std::string& n) { return !n.empty() && numbers.Read(n); })) {
      return SetFailure(fmt::format("line {}: expected a row of names, found numbers{}", lines_.number(),
                                    last_comment_ > 0 ? " (names behind a \"#\" are a comment: remove the mark)" : ""));
    }
    std::set<std::string> seen;
    for (std::size_t i = 0; i < names->size(); ++i) {
      const std::string& name = (*names)[i];
      if (name.empty()) return SetFailure(fmt::format("line {}, column {}: no name", lines_.number(), i + 1));
      if (!seen.insert(name).second) {
        return SetFailure(
            fmt::format("line {}, column {}: there are two columns \"{}\"", lines_.number(), i + 1, name));
      }
      record_.columns.push_back({.name = name, .unit = {}, .values = {}, .time = {}});
    }
    first_bad_line_.assign(names->size(), 0);
    return true;
  }

  bool SetFailure(std::string text) {
    failure_ = std::move(text);
    return false;
  }

  /// Takes the row as one of units if it looks like one.
  bool TakeUnits(std::string_view line) {
    std::optional<std::vector<std::string>> cells = Split(line);
    if (!cells) return false;
    if (cells->size() == record_.columns.size() + 1 && cells->back().empty()) cells->pop_back();
    if (cells->size() != record_.columns.size()) return false;
    bool any_word = false;
    for (const std::string& cell : *cells) {
      csv::NumberReader numbers(separator_ != ',');
      const bool is_number = !cell.empty() && numbers.Read(cell).has_value();
      if (is_number && cell != "1") return false;
      any_word = any_word || (!is_number && !cell.empty());
    }
    if (!any_word) return false;
    for (std::size_t i = 0; i < cells->size(); ++i) {
      std::string unit = (*cells)[i];
      if (unit.size() >= 2 &&
          ((unit.front() == '[' && unit.back() == ']') || (unit.front() == '(' && unit.back() == ')'))) {
        unit = std::string(csv::Trim(std::string_view(unit).substr(1, unit.size() - 2)));
      }
      record_.columns[i].unit = unit == "-" ? "1" : unit;
    }
    return true;
  }

  bool ReadRows() {
    csv::NumberReader numbers(separator_ != ',');
    std::optional<std::string_view> line = NextRow();
    if (line && TakeUnits(*line)) line = NextRow();
    if (line) Reserve(line->size() + 1);
    for (; line; line = NextRow()) ReadRow(*line, numbers);
    return true;
  }

  /// Room for the rows to come, judged by the length of the first; later ones may be longer, so take a little more.
  void Reserve(std::size_t line_bytes) {
    const std::size_t rows = file_bytes_ / line_bytes + file_bytes_ / line_bytes / 8;
    for (Column& column : record_.columns) column.values.reserve(rows);
  }

  void ReadRow(std::string_view line, csv::NumberReader& numbers) {
    const std::size_t width = record_.columns.size();
    std::size_t count = 0;
    for (bool more = true; more; ++count) {
      const std::optional<std::string_view> cell = csv::TakeCell(line, separator_, storage_, more);
      if (!cell) {
        Report(fmt::format(", column {}: a quote is not closed, or text follows it", count + 1));
        return;
      }
      if (count == width && cell->empty() && !more) return;  // a separator ends the line
      if (count < width) Store(count, *cell, numbers);
    }
    if (count != width) Report(fmt::format(": {} cells, the row of names has {}", count, width));
  }

  void Store(std::size_t index, std::string_view cell, csv::NumberReader& numbers) {
    Column& column = record_.columns[index];
    double value = std::numeric_limits<double>::quiet_NaN();
    if (!cell.empty()) {
      if (const std::optional<double> number = numbers.Read(cell)) {
        value = *number;
      } else {
        Report(fmt::format(", column {} ({}): {}", index + 1, column.name, numbers.Explain(cell)));
      }
    }
    if (!std::isfinite(value) && first_bad_line_[index] == 0) first_bad_line_[index] = lines_.number();
    column.values.push_back(value);
  }

  csv::Lines lines_;
  std::size_t file_bytes_;
  Record record_;
  char separator_ = ',';
  std::size_t last_comment_ = 0;
  std::string storage_;                      // of a quoted cell
  std::vector<std::size_t> first_bad_line_;  // a column: line of its first value that is not finite, 0 none
  std::vector<std::string> bad_;
  std::size_t bad_count_ = 0;
  std::string failure_;
};

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

Result<Record> ReadCsv(const std::filesystem::path& path) {
  const int descriptor = ::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NOCTTY);
  if (descriptor < 0) {
    return Failure{.message = errno == ENOENT ? "there is no such file"
                                              : "cannot be read: " + std::generic_category().message(errno),
                   .signal = path.string(),
                   .time_s = {},
                   .exit_code = 2};
  }
  struct stat info = {};
  const std::size_t bytes =
      ::fstat(descriptor, &info) == 0 && S_ISREG(info.st_mode) ? static_cast<std::size_t>(info.st_size) : 0;
  Result<Record> record = Reader(descriptor, path.string(), bytes).Read();
  ::close(descriptor);
  return record;
}

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
