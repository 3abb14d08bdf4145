// A plan as a flat list of paths and values, to see what an effect changed.
#pragma once

#include <fmt/format.h>

#include <map>
#include <string>
#include <vector>

#include "model/value.h"

namespace dynoproof::testing {

/// Path -> text of each value that is no table or array. Numbers are written so that equal text is equal value, whether
/// written as integer or not.
inline void Flatten(const Value& value, const std::string& path, std::map<std::string, std::string>& flat) {
  if (value.is_table()) {
    for (const Value::Entry& entry : value.table()) Flatten(entry.value, path + "." + entry.key, flat);
  } else if (value.is_array()) {
    for (std::size_t i = 0; i < value.array().size(); ++i)
      Flatten(value.array()[i], fmt::format("{}.{}", path, i), flat);
  } else {
    flat[path] = value.is_string() ? value.string()
                 : value.is_bool() ? (value.boolean() ? "true" : "false")
                                   : fmt::format("{}", value.number());
  }
}

/// The paths at which two trees differ, without the leading dot.
inline std::vector<std::string> Differences(const Value& a, const Value& b) {
  std::map<std::string, std::string> left, right;
  Flatten(a, "", left);
  Flatten(b, "", right);
  std::vector<std::string> paths;
  for (const auto& [path, text] : left) {
    if (const auto other = right.find(path); other == right.end() || other->second != text) {
      paths.push_back(path.substr(1));
    }
  }
  for (const auto& [path, text] : right) {
    if (!left.contains(path)) paths.push_back(path.substr(1));
  }
  return paths;
}

}  // namespace dynoproof::testing
