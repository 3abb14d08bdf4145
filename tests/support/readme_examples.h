// The TOML snippets of the plugins' READMEs, as tables: the conformance tests build every plugin from the example that
// a user reads, so that neither can rot.
#pragma once

#include <toml++/toml.h>

#include <filesystem>
#include <fstream>
#include <map>
#include <sstream>
#include <stdexcept>
#include <string>
#include <utility>

#include "model/value.h"

namespace dynoproof::testing {

struct Example {
  Value table;
  std::string readme;  // the whole text
};
using Examples = std::map<std::pair<std::string, std::string>, Example>;  // (kind, name)

inline Value FromToml(const toml::node& node) {
  if (const toml::table* table = node.as_table()) {
    Value value;
    for (const auto& [key, child] : *table) value[key.str()] = FromToml(child);
    return value;
  }
  if (const toml::array* array = node.as_array()) {
    Value::Array items;
    for (const toml::node& child : *array) items.push_back(FromToml(child));
    return items;
  }
  if (const auto* integer = node.as_integer()) return integer->get();
  if (const auto* number = node.as_floating_point()) return number->get();
  if (const auto* boolean = node.as_boolean()) return boolean->get();
  if (const auto* text = node.as_string()) return text->get();
  throw std::runtime_error("an example holds a date");
}

/// Takes every table that names a law, and every table with a type below source, actuator and sensor, provided that the
/// README's title names that plugin.
inline void Collect(const Value& value, const std::string& kind, const std::string& readme, Examples& examples) {
  if (value.is_array()) {
    for (const Value& item : value.array()) Collect(item, kind, readme, examples);
  }
  if (!value.is_table()) return;
  const Value *law = value.Find("law"), *type = value.Find("type");
  const std::string title = readme.substr(0, readme.find('\n'));
  const auto titled = [&title](const Value& name) {
    return title.find("`" + name.string() + "`") != std::string::npos;
  };
  if (law != nullptr && titled(*law)) examples[{"law", law->string()}] = {value, readme};
  if (type != nullptr && !kind.empty() && titled(*type)) examples[{kind, type->string()}] = {value, readme};
  for (const Value::Entry& entry : value.table()) {
    const bool stage = entry.key == "source" || entry.key == "actuator" || entry.key == "sensor";
    Collect(entry.value, stage ? entry.key : std::string(), readme, examples);
  }
}

/// All snippets below engine/plugins; the tests run in the root of the project.
inline Examples ReadmeExamples() {
  Examples examples;
  for (const auto& file : std::filesystem::recursive_directory_iterator("engine/plugins")) {
    if (file.path().filename() != "README.md") continue;
    std::stringstream text;
    text << std::ifstream(file.path()).rdbuf();
    const std::string readme = text.str(), fence = "```toml\n";
    for (std::size_t begin = readme.find(fence); begin != std::string::npos; begin = readme.find(fence, begin + 1)) {
      const std::size_t start = begin + fence.size();
      const std::string snippet = readme.substr(start, readme.find("```", start) - start);
      Collect(FromToml(toml::parse(snippet, file.path().string())), "", readme, examples);
    }
  }
  return examples;
}

}  // namespace dynoproof::testing
