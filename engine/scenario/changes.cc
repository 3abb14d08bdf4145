#include "scenario/changes.h"

#include <fmt/format.h>

#include <algorithm>

#include "scenario/load.h"

namespace dynoproof {
namespace {

/// A value as TOML, where it is short enough to be read in a sentence.
std::string Written(const Value& value) {
  constexpr std::size_t kMost = 60;
  std::string text = InlineToml(value);
  return text.size() > kMost ? text.substr(0, kMost) + " ..." : text;
}

/// What one tree has alone. A table within a table is told by its innermost name: "plant.load = { friction = { on = ..." would
/// break off before it says what.
std::string Alone(std::string path, const Value* value, const char* between) {
  for (; value->is_table() && value->table().size() == 1; value = &value->table().front().value)
    path += "." + value->table().front().key;
  return path + between + Written(*value);
}

bool IsListOfTables(const Value& value) {
  return value.is_array() && !value.array().empty() && std::ranges::all_of(value.array(), &Value::is_table);
}

/// The items of two lists that differ, as tables of these by number: without the equal ones with which both begin and end, so that an
/// item that is new or gone in the middle does not make those behind it other ones.
std::pair<Value, Value> DifferentItems(const Value::Array& was, const Value::Array& is) {
  const auto same = [](const Value& a, const Value& b) { return InlineToml(a) == InlineToml(b); };
  const std::size_t least = std::min(was.size(), is.size());
  std::size_t head = 0, tail = 0;
  while (head < least && same(was[head], is[head])) ++head;
  while (tail < least - head && same(was[was.size() - 1 - tail], is[is.size() - 1 - tail])) ++tail;
  const auto middle = [&](const Value::Array& list) {
    Value items;
    for (std::size_t i = head; i + tail < list.size(); ++i) items[fmt::format("{}", i)] = list[i];
    return items;
  };
  return {middle(was), middle(is)};
}

/// The values at which two trees differ, by their paths.
void Differences(const Value& was, const Value& is, const std::string& path, std::vector<std::string>& found) {
  if (IsListOfTables(was) && IsListOfTables(is)) {
    const auto [before, after] = DifferentItems(was.array(), is.array());
    Differences(before, after, path, found);
    return;
  }
  if (!was.is_table() || !is.is_table()) {
    const bool same =
        was.is_number() && is.is_number() ? was.number() == is.number() : InlineToml(was) == InlineToml(is);
    if (!same) found.push_back(fmt::format("{} = {} (was {})", path, Written(is), Written(was)));
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
    found.push_back(fmt::format("{} = {}", path, Written(value)));
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
