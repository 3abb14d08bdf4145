#include "scenario/nesting.h"

#include <algorithm>
#include <vector>

namespace dynoproof {
namespace {

/// Where a text in quotation marks that begins at `begin` ends: behind its last mark, or where the line does.
std::size_t EndOfText(std::string_view toml, std::size_t begin) {
  const char mark = toml[begin];
  const std::string_view three = toml.substr(begin, 3);
  const bool many_lines = three.size() == 3 && three[1] == mark && three[2] == mark;
  for (std::size_t k = begin + (many_lines ? 3 : 1); k < toml.size(); ++k) {
    if (toml[k] == '\\' && mark == '"') {
      ++k;
    } else if (many_lines ? toml.substr(k, 3) == three : toml[k] == mark) {
      return k + (many_lines ? 3 : 1);
    } else if (!many_lines && toml[k] == '\n') {
      return k;
    }
  }
  return toml.size();
}

const Value* TooDeepIn(const Value& value, int level) {
  if (level > kMostLevels) return &value;
  const Value* found = nullptr;
  if (value.is_array()) {
    for (const Value& item : value.array()) {
      if (found == nullptr) found = TooDeepIn(item, level + 1);
    }
  } else if (value.is_table()) {
    for (const Value::Entry& entry : value.table()) {
      if (found == nullptr) found = TooDeepIn(entry.value, level + 1);
    }
  }
  return found;
}

}  // namespace

const Value* ValueTooDeep(const Value& root) { return TooDeepIn(root, 0); }

std::optional<int> LineTooDeep(std::string_view toml) {
  std::vector<int> outside;  // the levels around each bracket that is open
  constexpr int kMostOfText = 2 * kMostLevels + 1;
  int level = 0, parts = 0, line = 1;
  bool after_point = false;
  for (std::size_t k = 0; k < toml.size();) {
    const char c = toml[k];
    std::size_t end = k + 1;
    if (c == '#') {
      end = std::min(toml.find('\n', k), toml.size());
    } else if (c == '[' || c == '{') {
      outside.push_back(level);
      level += parts + 1;
      parts = 0;
    } else if (c == ']' || c == '}') {
      if (!outside.empty()) {
        level = outside.back();
        outside.pop_back();
      }
      parts = 0;
    } else if (c == ',' || c == '\n') {
      parts = 0;
      after_point = false;
    } else if (c == '.') {
      after_point = true;
    } else if (c != ' ' && c != '\t' && c != '\r' && c != '=') {
      end =
          c == '"' || c == '\'' ? EndOfText(toml, k) : std::min(toml.find_first_of(" \t\r\n.=,#[]{}", k), toml.size());
      parts = after_point ? parts + 1 : 1;
      after_point = false;
    }
    if (level + parts > kMostOfText) return line;
    for (; k < end; ++k) line += toml[k] == '\n' ? 1 : 0;
  }
  return {};
}

}  // namespace dynoproof
