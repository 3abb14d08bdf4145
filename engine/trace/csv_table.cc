#include "trace/csv_table.h"

#include <algorithm>
#include <cctype>
#include <utility>

#include "trace/csv_text.h"
#include "trace/foreign_time.h"
#include "trace/record.h"

namespace dynoproof::trace::csv {
namespace {

bool NamesTime(const Row& row) {
  return std::ranges::any_of(row.cells, [](const std::string& cell) {
    std::string name = SplitHeading(cell).name;
    if (ForeignTime(name)) return true;
    std::ranges::transform(name, name.begin(), [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
    return IsTimeName(name);
  });
}

bool AllSpeakForUnits(const Row& row) {
  return std::ranges::all_of(row.cells, [](const std::string& c) { return c.empty() || SpeaksForUnits(c); });
}

/// Channels that are numbered: a word in the first cell, and numbers counted up in the others.
bool NumberedNames(const Row& row, std::size_t width) {
  constexpr std::size_t kMostDigits = 6;
  if (row.comment || !row.Fits(width) || width < 2 || row.cells[0].empty() || row.numbers[0]) return false;
  for (std::size_t i = 1; i < width; ++i) {
    const std::string& cell = row.cells[i];
    if (cell.empty() || cell.size() > kMostDigits || cell.find_first_not_of("0123456789") != std::string::npos ||
        (i > 1 && std::stoi(cell) != std::stoi(row.cells[i - 1]) + 1)) {
      return false;
    }
  }
  return true;
}

bool CouldBeNames(const Row& row, std::size_t width) { return row.Fits(width) && !row.any_number && row.any_word; }

}  // namespace

bool IsComment(const HeadLine& line) { return Trim(line.text).starts_with('#'); }

Row::Row(const HeadLine& line, char separator) : comment(IsComment(line)) {
  std::string_view text = Trim(line.text);
  if (comment) {
    text = Trim(text.substr(std::min(text.find_first_not_of('#'), text.size())));
  } else if (separator == '\t') {
    text = line.text;  // the first or the last cells may be empty
  }
  cells = Split(text, separator).value_or(std::vector<std::string>{});
  for (const std::string& cell : cells) {
    numbers.push_back(!cell.empty() && NumberReader(true).Read(cell).has_value());
    any_number = any_number || numbers.back();
    any_word = any_word || (!cell.empty() && !numbers.back());
  }
}

Reading::Reading(const std::vector<HeadLine>& head, char separator) : separator_(separator) {
  for (const HeadLine& line : head) rows_.emplace_back(line, separator);
}

std::vector<std::size_t> Reading::Widths() const {
  std::vector<std::pair<std::size_t, std::size_t>> counts;  // rows, width
  const auto count = [&](std::size_t width) {
    auto known = std::ranges::find(counts, width, &std::pair<std::size_t, std::size_t>::second);
    if (known == counts.end()) known = counts.insert(known, {0, width});
    ++known->first;
  };
  for (const Row& row : rows_) {
    if (row.comment || !row.any_number) continue;
    count(row.cells.size());
    if (row.cells.back().empty()) count(row.cells.size() - 1);
  }
  std::ranges::sort(counts, [](const auto& a, const auto& b) {
    return a.first != b.first ? a.first > b.first : a.second < b.second;
  });
  std::vector<std::size_t> widths;
  for (const auto& [rows, width] : counts) widths.push_back(width);
  return widths;
}

std::optional<Table> Reading::Find(std::size_t width) {
  FindNumericColumns(width);
  std::size_t data = 0;
  while (data < rows_.size() && !IsData(rows_[data], width)) ++data;
  if (data == rows_.size()) return {};
  Table table = {.separator = separator_, .width = width};
  if (!FindHeads(data, table)) return {};
  table.share = ShareOfNumbers(table);
  return table;
}

double Reading::ShareOfNumbers(const Table& table) const {
  std::size_t numbers = 0, cells = 0;
  for (std::size_t r = table.first; r < rows_.size(); ++r) {
    const Row& row = rows_[r];
    if (row.comment) continue;
    if (row.cells.empty()) ++cells;
    for (std::size_t i = 0; i < row.cells.size(); ++i) {
      cells += row.cells[i].empty() ? 0 : 1;
      numbers += row.numbers[i] && row.Fits(table.width) ? 1 : 0;
    }
  }
  return static_cast<double>(numbers) / static_cast<double>(std::max<std::size_t>(cells, 1));
}

void Reading::FindNumericColumns(std::size_t width) {
  std::vector<int> balance(width, 0);
  for (const Row& row : rows_) {
    if (row.comment || !row.any_number || !row.Fits(width)) continue;
    for (std::size_t i = 0; i < width; ++i) balance[i] += row.cells[i].empty() ? 0 : row.numbers[i] ? 1 : -1;
  }
  numeric_.assign(width, false);
  for (std::size_t i = 0; i < width; ++i) numeric_[i] = balance[i] >= 0;
}

bool Reading::IsData(const Row& row, std::size_t width) const {
  if (row.comment || !row.any_number || !row.Fits(width)) return false;
  if (numeric_[0] && NumberedNames(row, width)) return false;
  std::size_t numbers = 0, cells = 0;
  for (std::size_t i = 0; i < width; ++i) {
    if (!numeric_[i] || row.cells[i].empty()) continue;
    ++cells;
    numbers += row.numbers[i] ? 1 : 0;
  }
  return 2 * numbers > cells;
}

/// Whether a row below `names` is one of units. A row that merely cannot be read as numbers is none, nor one whose words
/// stand in columns of words.
bool Reading::IsUnits(const Row& row, std::size_t width, const Row* names) const {
  if (!row.Fits(width)) return false;
  std::size_t speak = 0, ones = 0;
  for (std::size_t i = 0; i < width; ++i) {
    if (row.numbers[i]) {
      if (row.cells[i] != "1" || i == 0) return false;
      if (names != nullptr && IsTimeName(SplitHeading(names->cells[i]).name)) return false;
      ++ones;
    } else if (numeric_[i] && SpeaksForUnits(row.cells[i])) {
      ++speak;
    }
  }
  return row.any_word ? speak > 0 && speak >= ones : ones == 0;
}

/// The rows of names and of units above the first row of data; false without names.
bool Reading::FindHeads(std::size_t data, Table& table) const {
  const std::size_t width = table.width;
  std::vector<std::size_t> group;  // neighbours without numbers, from below
  for (std::size_t r = data; r-- > 0;) {
    if (rows_[r].comment) continue;
    if (CouldBeNames(rows_[r], width)) {
      group.push_back(r);
    } else if (!group.empty()) {
      break;
    }
  }
  const bool lone_units = group.size() == 1 && group[0] > 0 && AllSpeakForUnits(rows_[group[0]]);
  if (lone_units && NumberedNames(rows_[group[0] - 1], width)) group.push_back(group[0] - 1);
  for (std::size_t r = data; group.empty() && r-- > 0;) {
    if (NumberedNames(rows_[r], width)) group.push_back(r);
  }
  if (group.empty()) {
    for (std::size_t r = data; r-- > 0 && rows_[r].comment && CouldBeNames(rows_[r], width);) group.push_back(r);
  }
  if (group.empty()) return false;
  const auto with_time = std::ranges::find_if(group, [&](std::size_t r) { return NamesTime(rows_[r]); });
  table.names = with_time != group.end() ? *with_time : group.front();
  const bool time_is_lowest = with_time == group.begin();
  if (group.size() > 1 && !time_is_lowest && IsUnits(rows_[group.front()], width, nullptr)) {
    table.units = group.front();  // rows of words between it and the names say kinds, places, ...
    if (with_time == group.end()) table.names = group[1];
  }
  table.first = table.units.value_or(table.names) + 1;
  if (table.units) return true;
  while (table.first < data && rows_[table.first].comment && !rows_[table.names].comment) ++table.first;
  if (table.first < data && IsUnits(rows_[table.first], width, &rows_[table.names])) table.units = table.first++;
  return true;
}

}  // namespace dynoproof::trace::csv
