// As much of JSON Schema as the published schemas use: type, required, properties, additionalProperties, items, enum
// and $ref into the document itself.
#pragma once

#include <algorithm>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace dynoproof::test {

class JsonSchema {
 public:
  explicit JsonSchema(nlohmann::json schema) : schema_(std::move(schema)) {}

  /// What is wrong with the document, one sentence each.
  std::vector<std::string> Faults(const nlohmann::json& document) const {
    std::vector<std::string> faults;
    Check(schema_, document, "$", faults);
    return faults;
  }

 private:
  static bool IsOf(const nlohmann::json& value, const std::string& type) {
    return (type == "object" && value.is_object()) || (type == "array" && value.is_array()) ||
           (type == "string" && value.is_string()) || (type == "number" && value.is_number()) ||
           (type == "integer" && value.is_number_integer()) || (type == "boolean" && value.is_boolean()) ||
           (type == "null" && value.is_null());
  }

  void Check(const nlohmann::json& schema, const nlohmann::json& value, const std::string& at,
             std::vector<std::string>& faults) const {
    if (schema.is_boolean()) {
      if (!schema.get<bool>()) faults.push_back(at + " must not be there");
      return;
    }
    for (const auto& [key, rule] : schema.items()) {
      static const std::vector<std::string> known = {
          "$schema",  "title",      "description",          "$defs", "$ref", "type", "enum",
          "required", "properties", "additionalProperties", "items"};
      if (std::find(known.begin(), known.end(), key) == known.end()) faults.push_back("unknown rule " + key);
    }
    if (schema.contains("$ref")) {
      const std::string ref = schema.at("$ref");
      Check(schema_.at(nlohmann::json::json_pointer(ref.substr(1))), value, at, faults);
    }
    if (schema.contains("type")) {
      const nlohmann::json& types = schema.at("type");
      bool good = false;
      for (const nlohmann::json& type : types.is_array() ? types : nlohmann::json::array({types}))
        good = good || IsOf(value, type);
      if (!good) faults.push_back(at + " is no " + types.dump());
    }
    if (schema.contains("enum") &&
        std::find(schema.at("enum").begin(), schema.at("enum").end(), value) == schema.at("enum").end())
      faults.push_back(at + " is none of " + schema.at("enum").dump());
    if (value.is_array() && schema.contains("items")) {
      for (std::size_t i = 0; i < value.size(); ++i)
        Check(schema.at("items"), value[i], at + "[" + std::to_string(i) + "]", faults);
    }
    if (!value.is_object()) return;
    for (const nlohmann::json& name : schema.value("required", nlohmann::json::array())) {
      if (!value.contains(name)) faults.push_back(at + " lacks " + name.dump());
    }
    const nlohmann::json properties = schema.value("properties", nlohmann::json::object());
    for (const auto& [name, item] : value.items()) {
      const nlohmann::json& rule = properties.contains(name)                 ? properties.at(name)
                                   : schema.contains("additionalProperties") ? schema.at("additionalProperties")
                                                                             : nlohmann::json(true);
      Check(rule, item, at + "." + name, faults);
    }
  }

  const nlohmann::json schema_;
};

}  // namespace dynoproof::test
