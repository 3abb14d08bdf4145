#include "model/value.h"

#include <algorithm>
#include <charconv>

namespace dynoproof {

Value::Value(std::initializer_list<std::pair<const char*, Value>> entries) : data_(Table{}) {
  for (const auto& [key, value] : entries) table().push_back({key, value, {}});
}

std::string Value::KindName() const {
  if (is_table()) return "a table";
  if (is_array()) return "an array";
  if (is_string()) return "a string";
  if (is_bool()) return "a boolean";
  return is_integer() ? "an integer" : "a number";
}

const Value* Value::Find(std::string_view key) const {
  if (!is_table()) return nullptr;
  const auto it = std::find_if(table().begin(), table().end(), [key](const Entry& entry) { return entry.key == key; });
  return it == table().end() ? nullptr : &it->value;
}

Value* Value::Find(std::string_view key) { return const_cast<Value*>(std::as_const(*this).Find(key)); }

Value& Value::operator[](std::string_view key) {
  if (Value* found = Find(key)) return *found;
  table().push_back({std::string(key), Value(), {}});
  return table().back().value;
}

void Value::Erase(std::string_view key) {
  if (is_table()) std::erase_if(table(), [key](const Entry& entry) { return entry.key == key; });
}

const Value* Value::FindPath(std::string_view path) const {
  const Value* here = this;
  while (here != nullptr && !path.empty()) {
    const std::size_t dot = std::min(path.find('.'), path.size());
    const std::string_view key = path.substr(0, dot);
    path.remove_prefix(std::min(dot + 1, path.size()));
    if (here->is_array()) {
      std::size_t index = 0;
      const auto [end, error] = std::from_chars(key.data(), key.data() + key.size(), index);
      const bool valid = error == std::errc() && end == key.data() + key.size() && index < here->array().size();
      here = valid ? &here->array()[index] : nullptr;
    } else {
      here = here->Find(key);
    }
  }
  return here;
}

Value* Value::FindPath(std::string_view path) { return const_cast<Value*>(std::as_const(*this).FindPath(path)); }

double Value::NumberOr(std::string_view path, double fallback) const {
  const Value* found = FindPath(path);
  return found != nullptr && found->is_number() ? found->number() : fallback;
}

std::string Value::TextOr(std::string_view path, std::string_view fallback) const {
  const Value* found = FindPath(path);
  return found != nullptr && found->is_string() ? found->string() : std::string(fallback);
}

std::vector<std::string> KeysOf(const Value& value) {
  std::vector<std::string> keys;
  if (value.is_table()) {
    for (const Value::Entry& entry : value.table()) keys.push_back(entry.key);
  }
  return keys;
}

void MergeInto(Value& base, const Value& patch) {
  for (const Value::Entry& entry : patch.table()) {
    Value* old = base.Find(entry.key);
    if (old == nullptr) {
      base.table().push_back(entry);
    } else if (old->is_table() && entry.value.is_table()) {
      MergeInto(*old, entry.value);
    } else {
      *old = entry.value;
    }
  }
}

}  // namespace dynoproof
