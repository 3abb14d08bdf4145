#include "trace/csv_layout.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <utility>

#include "base/text_safety.h"
#include "trace/csv_table.h"
#include "trace/csv_text.h"

namespace dynoproof::trace::csv {
namespace {

/// Why there is no table.
std::string WhyNot(const std::vector<HeadLine>& head, const std::vector<char>& separators) {
  std::size_t first = 0;
  while (first < head.size() && IsComment(head[first])) ++first;
  if (first == head.size()) return "is empty: expected a row of names and rows of numbers";
  const HeadLine* numbers = nullptr;  // the first row of them, by the separator that finds the most
  std::size_t cells = 0, most = 0;
  bool quote_is_wrong = Row(head[first], separators.front()).cells.empty();  // of the first line, by that separator
  for (const char separator : separators) {
    const HeadLine* row_of_numbers = nullptr;
    std::size_t found = 0, width = 0;
    for (const HeadLine& line : head) {
      const Row row(line, separator);
      if (row.comment || !row.any_number) continue;
      found += static_cast<std::size_t>(std::ranges::count(row.numbers, true));
      if (row_of_numbers != nullptr) continue;
      row_of_numbers = &line;
      width = row.cells.size();
    }
    if (found <= most) continue;
    most = found;
    numbers = row_of_numbers;
    cells = width;
    quote_is_wrong = Row(head[first], separator).cells.empty();
  }
  if (quote_is_wrong) return fmt::format("line {}: a quote is not closed, or text follows it", head[first].number);
  if (numbers == nullptr) {
    return fmt::format("has no data: line {} is {}, and no row of numbers follows", head[first].number,
                       Shown(head[first].text));
  }
  if (numbers == &head[first]) {
    return fmt::format("line {}: expected a row of names, found numbers", numbers->number);
  }
  return fmt::format("line {}: a row of numbers with {} cell{}, but no row of names before it has as many",
                     numbers->number, cells, cells == 1 ? "" : "s");
}

/// `sep=;`, which spreadsheets write for each other.
std::optional<char> Declared(std::string_view line) {
  if (line.size() >= 2 && line.front() == '"' && line.back() == '"') line = line.substr(1, line.size() - 2);
  constexpr std::string_view kWord = "sep=";
  while (line.size() > kWord.size() + 1 && line.ends_with(' ')) line.remove_suffix(1);
  if (line.size() != kWord.size() + 1) return {};
  for (std::size_t i = 0; i < kWord.size(); ++i) {
    if (std::tolower(static_cast<unsigned char>(line[i])) != kWord[i]) return {};
  }
  return line.back();
}

/// Names that the split from their units made equal keep their whole headings.
void KeepApart(std::vector<Heading>& columns) {
  std::vector<bool> equal(columns.size(), false);
  for (std::size_t i = 0; i < columns.size(); ++i) {
    for (std::size_t k = 0; k < columns.size(); ++k) {
      equal[i] = equal[i] || (k != i && columns[k].name == columns[i].name);
    }
  }
  for (std::size_t i = 0; i < columns.size(); ++i) {
    if (equal[i] && !columns[i].heading.empty()) columns[i].name = std::exchange(columns[i].heading, "");
  }
}

/// The decimal mark, from the numbers of the first lines.
void FindMark(const std::vector<std::string>& numbers, Layout& layout) {
  struct Count {
    std::size_t all = 0, sure = 0, first = 0;
  } points, commas;
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    const std::size_t mark = numbers[i].find_first_of(".,");
    if (mark == std::string::npos) continue;
    Count& count = numbers[i][mark] == '.' ? points : commas;
    if (count.all++ == 0) count.first = i;
    count.sure += LooksLikeThousands(numbers[i]) ? 0 : 1;
  }
  // Where none of them has a mark, a comma farther down may part thousands.
  layout.comma_allowed = layout.separator == ';';
  if (points.all == 0 && commas.all == 0) return;
  if (points.all == 0) {
    // "1,234" and nothing else to go by: a decimal comma where the semicolon shows that the comma is one.
    if (commas.sure > 0 || layout.comma_allowed) layout.mark = ',';
  } else if (commas.all == 0) {
    layout.mark = '.';
  } else if ((points.sure == 0) != (commas.sure == 0)) {
    layout.mark = points.sure > 0 ? '.' : ',';
  } else if (points.all != commas.all) {
    layout.mark = points.all > commas.all ? '.' : ',';
  } else {
    layout.mark = points.first < commas.first ? '.' : ',';
  }
}

}  // namespace

Layout FindLayout(const std::vector<HeadLine>& head) {
  Layout layout;
  std::vector<char> separators = {';', '\t', ',', ' ', kWideBlanks};
  std::vector<HeadLine> lines = head;
  std::size_t dropped = 0;
  if (const std::optional<char> declared = head.empty() ? std::nullopt : Declared(head.front().text)) {
    separators = {*declared};
    lines.erase(lines.begin());
    dropped = 1;
  }
  std::optional<Table> best;
  std::vector<Row> rows;
  for (const char separator : separators) {
    Reading reading(lines, separator);
    for (const std::size_t width : reading.Widths()) {
      // Without any separator "0,1" would be one number, where it is two.
      if (width == 1 && separator != ',' && dropped == 0) continue;
      const std::optional<Table> table = reading.Find(width);
      if (!table || (best && table->share <= best->share)) continue;
      best = table;
      rows = reading.rows();
    }
  }
  if (!best) {
    layout.fault = WhyNot(lines, separators);
    return layout;
  }
  layout.separator = best->separator;
  layout.names_line = lines[best->names].number;
  layout.first_row = best->first + dropped;
  for (std::size_t i = 0; i < best->width; ++i) layout.columns.push_back(SplitHeading(rows[best->names].cells[i]));
  KeepApart(layout.columns);
  if (best->units) {
    for (std::size_t i = 0; i < best->width; ++i) {
      const std::string& cell = rows[*best->units].cells[i];
      if (!cell.empty()) layout.columns[i].unit = UnitOfCell(cell);
    }
  }
  std::vector<std::string> numbers;
  for (std::size_t r = best->first; r < rows.size(); ++r) {
    for (std::size_t i = 0; i < rows[r].cells.size() && !rows[r].comment; ++i) {
      if (rows[r].numbers[i]) numbers.push_back(rows[r].cells[i]);
    }
  }
  FindMark(numbers, layout);
  if (rows[best->names].comment) {
    layout.notes.push_back(fmt::format("the names are taken from the comment in line {}", layout.names_line));
  }
  for (std::size_t r = best->names + 1; best->units && r < *best->units; ++r) {
    if (rows[r].comment) continue;
    layout.notes.push_back(
        fmt::format("line {} between names and units is skipped: {}", lines[r].number, Shown(lines[r].text)));
  }
  const auto skipped = std::find_if(lines.begin(), lines.begin() + static_cast<std::ptrdiff_t>(best->names),
                                    [](const HeadLine& line) { return !IsComment(line); });
  if (skipped != lines.begin() + static_cast<std::ptrdiff_t>(best->names)) {
    layout.notes.push_back(
        fmt::format("the names are in line {}; what stands before them is skipped, line {} first: {}",
                    layout.names_line, skipped->number, Shown(skipped->text)));
  }
  return layout;
}

}  // namespace dynoproof::trace::csv
