#include "trace/csv_heading.h"

#include <algorithm>
#include <cctype>
#include <optional>

#include "base/units.h"
#include "trace/csv_text.h"

namespace dynoproof::trace::csv {
namespace {

/// Where the bracket opens that the last character closes.
std::size_t OpeningOf(std::string_view text, char open, char close) {
  int depth = 0;
  for (std::size_t i = text.size(); i-- > 0;) {
    depth += text[i] == close ? 1 : text[i] == open ? -1 : 0;
    if (depth == 0) return i;
  }
  return std::string_view::npos;
}

/// What is within the brackets that enclose all of `text`; nothing without such.
std::optional<std::string_view> Within(std::string_view text, char open, char close) {
  if (text.size() < 2 || text.back() != close || OpeningOf(text, open, close) != 0) return {};
  return Trim(text.substr(1, text.size() - 2));
}

/// More than a number or a dash, which ParseUnit takes as dimensionless.
bool IsNamedUnit(std::string_view text) {
  const bool named = std::any_of(text.begin(), text.end(), [](char c) {
    return std::isalpha(static_cast<unsigned char>(c)) != 0 || c == '%' || static_cast<unsigned char>(c) >= 0x80;
  });
  return named && ParseUnit(text).has_value();
}

}  // namespace

Heading SplitHeading(std::string_view cell) {
  const auto split = [&](std::string_view name, std::string_view unit) {
    return Heading{std::string(Trim(name)), UnitOfCell(unit), std::string(cell)};
  };
  for (const auto& [open, close] : {std::pair('[', ']'), std::pair('(', ')')}) {
    if (!cell.ends_with(close)) continue;
    const std::size_t at = OpeningOf(cell, open, close);
    if (at == std::string_view::npos) continue;
    std::string_view name = Trim(cell.substr(0, at));
    if (name.ends_with('/')) name.remove_suffix(1);  // "v/(m/s)"
    if (Trim(name).empty()) continue;
    const std::string_view inner = *Within(cell.substr(at), open, close);
    // "x (1)" is the first of several x, "x [1]" and "x [-]" have no dimension.
    if (IsNamedUnit(inner) || inner == "-" || (open == '[' && inner == "1")) return split(name, inner);
  }
  for (std::size_t at = cell.find('/'); at != std::string_view::npos; at = cell.find('/', at + 1)) {
    const std::string_view name = Trim(cell.substr(0, at)), unit = Trim(cell.substr(at + 1));
    // "m/s" is no quantity m in seconds, "V1/V2" no V1 in square volts.
    if (!name.empty() && IsNamedUnit(unit) && !ParseUnit(name)) return split(name, unit);
  }
  return {std::string(cell), "", ""};
}

std::string UnitOfCell(std::string_view cell) {
  for (const auto& [open, close] : {std::pair('[', ']'), std::pair('(', ')')}) {
    if (const auto inner = Within(cell, open, close)) cell = *inner;
  }
  return cell == "-" ? "1" : std::string(cell);
}

bool SpeaksForUnits(std::string_view cell) {
  if (Within(cell, '[', ']')) return true;
  std::string unit = UnitOfCell(cell);
  if (!IsNamedUnit(unit)) return false;
  std::transform(unit.begin(), unit.end(), unit.begin(),
                 [](char c) { return static_cast<char>(std::tolower(static_cast<unsigned char>(c))); });
  return unit != "n/a";
}

}  // namespace dynoproof::trace::csv
