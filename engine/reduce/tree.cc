#include "reduce/tree.h"

#include <algorithm>

namespace dynoproof::reduce {

bool IsGone(const Value& value) { return value.is_string() && value.string() == kGone; }

void Sweep(Value& value) {
  if (value.is_array()) {
    std::erase_if(value.array(), IsGone);
    for (Value& item : value.array()) Sweep(item);
  }
  if (!value.is_table()) return;
  for (Value::Entry& entry : value.table()) Sweep(entry.value);
  std::erase_if(value.table(), [](const Value::Entry& entry) {
    const bool empty_list = entry.value.is_array() && entry.value.array().empty();
    return IsGone(entry.value) || empty_list || (entry.value.is_table() && entry.value.table().empty());
  });
}

Move Without(const std::string& path) {
  return {path, [path](Value& root) {
            Value* value = root.FindPath(path);
            if (value == nullptr || IsGone(*value)) return false;
            *value = Value(kGone);
            return true;
          }};
}

std::string BodyOf(std::string_view end) { return std::string(end.substr(0, end.find('.'))); }

const Value::Table& TableAt(const Value& root, std::string_view path) {
  static const Value::Table none;
  const Value* value = root.FindPath(path);
  return value != nullptr && value->is_table() ? value->table() : none;
}

const Value::Array& ListAt(const Value& root, std::string_view path) {
  static const Value::Array none;
  const Value* value = root.FindPath(path);
  return value != nullptr && value->is_array() ? value->array() : none;
}

std::set<std::string> DifferingNumbers(const Value& a, const Value& b, const std::string& path) {
  std::set<std::string> paths;
  for (const Value::Entry& entry : TableAt(a, path)) {
    const std::string at = path + "." + entry.key;
    const Value* other = b.FindPath(at);
    if (other == nullptr) continue;
    if (entry.value.is_number() && other->is_number() && entry.value.number() != other->number()) paths.insert(at);
    if (entry.value.is_table()) paths.merge(DifferingNumbers(a, b, at));
  }
  return paths;
}

}  // namespace dynoproof::reduce
