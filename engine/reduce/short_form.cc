#include "reduce/short_form.h"

#include <fmt/format.h>

#include <algorithm>

#include "scenario/load.h"

namespace dynoproof::reduce {
namespace {

constexpr std::size_t kWidth = 130;
constexpr std::size_t kFew = 2;  // entries of a table that needs no heading

/// "key = value", or the key alone.
std::string Line(const std::string& key, const Value& value) {
  const std::string braced = InlineToml(Value{{key.c_str(), value}});  // "{ key = value }"
  return braced.substr(2, braced.size() - 4);
}
std::string Key(const std::string& key) {
  const std::string line = Line(key, Value(true));
  return line.substr(0, line.size() - std::string_view(" = true").size());
}

bool IsListOfTables(const Value& value) {
  return value.is_array() && !value.array().empty() && std::ranges::all_of(value.array(), &Value::is_table);
}

/// A table whose entries are named things: the inputs, the shafts.
bool IsTableOfTables(const Value& value) {
  return value.is_table() && !value.table().empty() &&
         std::ranges::all_of(value.table(), [](const Value::Entry& entry) { return entry.value.is_table(); });
}

struct Text {
  std::string lines, sections;
};

/// The entries of a table as lines of the section `path`, each key behind `prefix`, and what is too long for a line as sections.
void Write(const Value& table, const std::string& path, const std::string& prefix, Text& text) {
  for (const Value::Entry& entry : table.table()) {
    const std::string name = path.empty() ? Key(entry.key) : path + "." + Key(entry.key);
    const std::string line = prefix + Line(entry.key, entry.value);
    const bool list = path.empty() && IsListOfTables(entry.value);
    if (line.size() <= kWidth || !(entry.value.is_table() || list)) {
      text.lines += line + "\n";
    } else if (list) {
      for (const Value& item : entry.value.array()) {
        text.sections += fmt::format("\n[[{}]]\n", name);
        for (const Value::Entry& inner : item.table()) text.sections += Line(inner.key, inner.value) + "\n";
      }
    } else if (IsTableOfTables(entry.value) || entry.value.table().size() <= kFew) {
      // Each on its line, as "shaft.k3 = { ... }"; of two entries the prefix is read sooner than a heading.
      Write(entry.value, name, prefix + Key(entry.key) + ".", text);
    } else {
      Text inner;
      Write(entry.value, name, "", inner);
      text.sections += fmt::format("\n[{}]\n{}{}", name, inner.lines, inner.sections);
    }
  }
}

}  // namespace

std::string ShortForm(const Value& root) {
  Text text;
  Write(root, "", "", text);
  return text.lines + text.sections;
}

std::size_t LinesOf(const std::string& toml) {
  std::size_t lines = 0;
  for (std::size_t i = 0; i < toml.size(); ++i) lines += toml[i] != '\n' && (i == 0 || toml[i - 1] == '\n') ? 1 : 0;
  return lines;
}

std::size_t ValuesOf(const Value& value) {
  std::size_t values = 0;
  if (value.is_table()) {
    for (const Value::Entry& entry : value.table()) values += ValuesOf(entry.value);
  } else if (value.is_array()) {
    for (const Value& item : value.array()) values += ValuesOf(item);
  } else {
    values = 1;
  }
  return values;
}

}  // namespace dynoproof::reduce
