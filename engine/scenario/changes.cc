#include "scenario/changes.h"

#include <fmt/format.h>

#include "scenario/load.h"

namespace dynoproof {
namespace {

/// A value as TOML, where it is short enough to be read in a sentence.
std::string Shown(const Value& value) {
  constexpr std::size_t kMost = 60;
  std::string text = InlineToml(value);
  return text.size() > kMost ? text.substr(0, kMost) + " ..." : text;
}

/// What one tree has alone. A table within a table is told by its innermost name: "plant.load = { friction = { on = ..." would
/// break off before it says what.
std::string Alone(std::string path, const Value* value, const char* between) {
  for (; value->is_table() && value->table().size() == 1; value = &value->table().front().value)
    path += "." + value->table().front().key;
  return path + between + Shown(*value);
}

/// The values at which two trees differ, by their paths.
void Differences(const Value& was, const Value& is, const std::string& path, std::vector<std::string>& found) {
  if (!was.is_table() || !is.is_table()) {
    const bool same =
        was.is_number() && is.is_number() ? was.number() == is.number() : InlineToml(was) == InlineToml(is);
    if (!same) found.push_back(fmt::format("{} = {} (was {})", path, Shown(is), Shown(was)));
    return;
  }
  const std::string before = path.empty() ? "" : path + ".";
  for (const Value::Entry& entry : is.table()) {
    if (const Value* const old = was.Find(entry.key); old != nullptr)
      Differences(*old, entry.value, before + entry.key, found);
    else
      found.push_back(fmt::format("{} (was not there)", Alone(before + entry.key, &entry.value, " = ")));
  }
  for (const Value::Entry& entry : was.table()) {
    if (is.Find(entry.key) == nullptr)
      found.push_back(fmt::format("{})", Alone(before + entry.key, &entry.value, " is gone (was ")));
  }
}

void Leaves(const Value& value, const std::string& path, std::vector<std::string>& found) {
  if (!value.is_table()) {
    found.push_back(fmt::format("{} = {}", path, Shown(value)));
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
