#include "scenario/changes.h"

#include <fmt/format.h>

#include "scenario/load.h"

namespace dynoproof {
namespace {

/// A value as TOML, where it is short enough to be read in a sentence.
std::string Shown(const Value* value) {
  constexpr std::size_t kMost = 60;
  if (value == nullptr) return "not there";
  std::string text = InlineToml(*value);
  return text.size() > kMost ? text.substr(0, kMost) + " ..." : text;
}

/// The values at which two trees differ, by their paths.
void Differences(const Value& was, const Value& is, const std::string& path, std::vector<std::string>& found) {
  if (!was.is_table() || !is.is_table()) {
    const bool same =
        was.is_number() && is.is_number() ? was.number() == is.number() : InlineToml(was) == InlineToml(is);
    if (!same) found.push_back(fmt::format("{} = {} (was {})", path, Shown(&is), Shown(&was)));
    return;
  }
  const std::string before = path.empty() ? "" : path + ".";
  for (const Value::Entry& entry : is.table()) {
    if (const Value* const old = was.Find(entry.key); old != nullptr)
      Differences(*old, entry.value, before + entry.key, found);
    else
      found.push_back(fmt::format("{}{} = {} (was {})", before, entry.key, Shown(&entry.value), Shown(nullptr)));
  }
  for (const Value::Entry& entry : was.table()) {
    if (is.Find(entry.key) == nullptr)
      found.push_back(fmt::format("{}{} is gone (was {})", before, entry.key, Shown(&entry.value)));
  }
}

void Leaves(const Value& value, const std::string& path, std::vector<std::string>& found) {
  if (!value.is_table()) {
    found.push_back(fmt::format("{} = {}", path, Shown(&value)));
    return;
  }
  for (const Value::Entry& entry : value.table())
    Leaves(entry.value, path.empty() ? entry.key : path + "." + entry.key, found);
}

}  // namespace

std::vector<std::string> StatedValues(const Value& tree) {
  std::vector<std::string> found;
  Leaves(tree, "", found);
  return found;
}

std::vector<std::string> ChangesBetween(const Value& was, const Value& is) {
  std::vector<std::string> found;
  Differences(was, is, "", found);
  return found;
}

}  // namespace dynoproof
