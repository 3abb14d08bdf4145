#include "trace/csv_cells.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "base/text_safety.h"

namespace dynoproof::trace::csv {

CellColumns::CellColumns(const Layout& layout)
    : layout_(layout), numbers_(layout.comma_allowed, layout.mark), columns_(layout.columns.size()) {
  for (std::size_t i = 0; i < columns_.size(); ++i) {
    const std::string& name = layout.columns[i].name;
    has_time_ = has_time_ || IsTimeName(name);
    if (name.empty()) columns_[i].unwanted = "has no name";
    for (std::size_t k = 0; k < i && !name.empty(); ++k) {
      if (layout.columns[k].name != name) continue;
      if (IsTimeName(name) && fault_.empty()) {
        fault_ = fmt::format("line {}: columns {} and {} are both {}, and either could be the time", layout.names_line,
                             k + 1, i + 1, Shown(name));
      }
      columns_[i].unwanted = columns_[k].unwanted =
          fmt::format("is there twice in line {} (columns {} and {})", layout.names_line, k + 1, i + 1);
    }
  }
}

std::string CellColumns::FaultOfNames() const { return fault_; }

void CellColumns::Reserve(std::size_t rows) {
  for (Column& column : columns_) column.values.reserve(rows);
}

void CellColumns::Store(std::size_t index, std::string_view cell, std::size_t line) {
  Column& column = columns_[index];
  double value = std::numeric_limits<double>::quiet_NaN();
  column.last = Column::Kind::kNothing;
  if (index == 0 && layout_.raster) {
    value = layout_.raster->start + layout_.raster->step * static_cast<double>(rows_);
    column.last = Column::Kind::kNumber;
    ++column.numbers;
  } else if (!cell.empty()) {
    if (const std::optional<double> number = numbers_.Read(cell)) {
      value = *number;
      column.last = Column::Kind::kNumber;
      ++column.numbers;
    } else {
      column.last = Column::Kind::kWord;
      const bool may_be_clock = column.numbers == 0 && column.stamps == column.words;
      if (const std::optional<double> stamp = may_be_clock ? column.clock.Read(cell) : std::nullopt) {
        value = *stamp;
        column.last = Column::Kind::kStamp;
        ++column.stamps;
      }
      if (column.words++ == 0) {
        column.first_word = numbers_.Explain(cell);
        column.first_word_line = line;
      }
    }
  }
  if (!std::isfinite(value) && column.first_bad_line == 0) column.first_bad_line = line;
  column.values.push_back(value);
}

void CellColumns::DropRow(std::size_t line) {
  std::size_t most = 0;
  for (const Column& column : columns_) most = std::max(most, column.values.size());
  if (most == rows_ && rows_ > 0) --rows_;
  for (Column& column : columns_) {
    if (column.values.size() <= rows_) continue;  // the row ended before it
    column.values.pop_back();
    if (column.last == Column::Kind::kNumber) --column.numbers;
    if (column.last == Column::Kind::kWord || column.last == Column::Kind::kStamp) --column.words;
    if (column.last == Column::Kind::kStamp) --column.stamps;
    if (column.first_bad_line == line) column.first_bad_line = 0;
  }
}

void CellColumns::DropEmptyRows(std::size_t count) {
  rows_ -= count;
  for (Column& column : columns_) {
    column.values.resize(rows_);
    if (std::ranges::all_of(column.values, [](double v) { return std::isfinite(v); })) column.first_bad_line = 0;
  }
}

void CellColumns::ForgetStamps(Column& column) {
  if (column.stamps == 0 || IsClock(column)) return;
  for (std::size_t i = 0, left = column.stamps; left > 0 && i < column.values.size(); ++i) {
    if (std::isnan(column.values[i])) continue;
    column.values[i] = std::numeric_limits<double>::quiet_NaN();
    --left;
  }
  column.first_bad_line =
      column.first_bad_line == 0 ? column.first_word_line : std::min(column.first_bad_line, column.first_word_line);
}

/// Why a column is none of numbers, or nothing.
std::string CellColumns::WhyNot(const Column& column) {
  if (!column.unwanted.empty()) return column.unwanted;
  if (IsClock(column)) return "";
  if (column.numbers == 0 && column.words == 0) return "is empty throughout";
  if (column.words <= column.numbers) return "";
  constexpr std::string_view kPlain = " is not a number";
  const std::string& word = column.first_word;
  if (!word.ends_with(kPlain)) return fmt::format("is not read: in line {}, {}", column.first_word_line, word);
  return fmt::format("is text: {} in line {}", word.substr(0, word.size() - kPlain.size()), column.first_word_line);
}

void CellColumns::MoveTo(Record& record) {
  std::string left_out;
  for (std::size_t i = 0; i < columns_.size(); ++i) {
    Column& column = columns_[i];
    ForgetStamps(column);
    const Heading& heading = layout_.columns[i];
    const bool nameless = heading.name.empty();
    const std::string name = nameless ? fmt::format("column {}", i + 1) : WithoutControls(heading.name);
    if (std::string why = WhyNot(column); !why.empty()) {
      const bool padding = nameless && column.numbers == 0 && column.words == 0;
      const bool known = std::ranges::any_of(record.left_out, [&](const auto& entry) { return entry.first == name; });
      if (padding || known) continue;  // separators without end; the second of two
      left_out += fmt::format("{}{} {}", left_out.empty() ? "" : "; ", nameless ? name : Shown(name), why);
      record.left_out.emplace_back(name, std::move(why));
      continue;
    }
    if (IsClock(column)) {
      record.notes.push_back(
          fmt::format("{} holds stamps of a clock: seconds from the midnight before the first one", Shown(name)));
    } else if (column.words > 0) {
      record.notes.push_back(
          fmt::format("column {} ({}): {} of {} cells {} no number and left empty, the first in line {}: {}", i + 1,
                      name, column.words, column.values.size(), column.words == 1 ? "is" : "are",
                      column.first_word_line, column.first_word));
    }
    if (layout_.time == i) record.time = record.columns.size();
    if (column.first_bad_line > 0) {
      record.non_finite.push_back({.column = record.columns.size(), .first_line = column.first_bad_line});
    }
    record.columns.push_back({.name = name,
                              .unit = IsClock(column) ? "s" : WithoutControls(heading.unit),
                              .values = std::move(column.values),
                              .time = {},
                              .heading = WithoutControls(heading.heading)});
  }
  if (!left_out.empty()) record.notes.push_back("left out: " + left_out);
}

}  // namespace dynoproof::trace::csv
