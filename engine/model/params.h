// One list of parameters serves parsing, range checks, `describe` and the README tables. A plugin writes
//
//   struct Params {
//     double stiffness_Nm_per_rad = 0.0;
//     void Visit(auto& v) { v.Required("stiffness_Nm_per_rad", stiffness_Nm_per_rad, Positive(), "stiffness k"); }
//     void Check(Faults& faults) const;  // optional: rules between parameters
//   };
//
// and the visitors of this file do the rest. Units come from the key's suffix (base/units.h) or from the range.
#pragma once

#include <fmt/format.h>

#include <cmath>
#include <concepts>
#include <limits>
#include <map>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

#include "base/diagnostics.h"
#include "base/text.h"
#include "base/units.h"
#include "model/motion.h"
#include "model/value.h"

namespace dynoproof {

/// The numbers a parameter may take, and its unit where the key carries none. NaN and infinity are never in a range.
struct Range {
  std::string unit;
  double lower = -std::numeric_limits<double>::infinity();
  double upper = std::numeric_limits<double>::infinity();
  bool open = false;  // the lower bound itself is excluded

  bool Contains(double value) const {
    return std::isfinite(value) && (open ? value > lower : value >= lower) && value <= upper;
  }
  std::string ToString() const;
};
inline Range Any(std::string unit = "") { return {std::move(unit)}; }
inline Range Positive(std::string unit = "") {
  return {std::move(unit), 0.0, std::numeric_limits<double>::infinity(), true};
}
inline Range NonNegative(std::string unit = "") { return {std::move(unit), 0.0}; }
inline Range Between(double lower, double upper, std::string unit = "") { return {std::move(unit), lower, upper}; }

/// One parameter as `describe` shows it.
struct ParamInfo {
  std::string name, type, unit, range, fallback, description;  // fallback empty: required
};

/// Reports a fault at a parameter of a table.
class Faults {
 public:
  Faults(const Value& table, Diagnostics& diagnostics, std::string context, Motion motion = Motion::kRotation)
      : table_(table), diagnostics_(diagnostics), context_(std::move(context)), motion_(motion) {}

  /// An error at that key, or at the table when the key is not written. Keys that the texts mention are told as they are
  /// in this motion.
  void At(std::string_view key, std::string_view message, std::string_view hint = "");
  const std::string& context() const { return context_; }

 private:
  const Value& table_;
  Diagnostics& diagnostics_;
  std::string context_;
  Motion motion_;
};

/// Reads a table into a Params struct; every fault becomes a diagnostic.
class ParamReader {
 public:
  /// `context` names the table in messages ("source.chirp"); `known` are keys that somebody else reads. Keys and units of
  /// rotation are read as those of `motion`.
  ParamReader(const Value& table, Diagnostics& diagnostics, std::string context, std::vector<std::string> known = {},
              Motion motion = Motion::kRotation);

  template <class T, class Rule>
  void Required(const char* key, T& field, const Rule& rule, const char* description) {
    Read(key, field, rule, true, description);
  }
  template <class T, class Rule>
  void Optional(const char* key, T& field, const Rule& rule, const char* description) {
    Read(key, field, rule, false, description);
  }
  /// Reports the keys that nobody asked for, each with the nearest known one. Call once, at the end.
  void Finish();
  bool ok() const { return ok_; }

 private:
  using Choices = std::vector<std::string>;

  template <class T, class Rule>
  void Read(const char* name, T& field, const Rule& rule, bool required, const char* description) {
    const std::string own = KeyIn(motion_, table_, name);
    const char* key = own.c_str();
    const Value* value = Take(key, RuleText(key, rule), required, description);
    if (value != nullptr && !Assign(*value, key, field, rule)) ok_ = false;
  }
  const Value* Take(const char* key, const std::string& rule, bool required, const char* description);
  std::string RuleText(const char* key, const Range& range) const;
  static std::string RuleText(const char*, const Choices& choices);

  bool Assign(const Value& value, const char* key, double& field, const Range& range);
  bool Assign(const Value& value, const char* key, int& field, const Range& range);
  bool Assign(const Value& value, const char* key, std::int64_t& field, const Range& range);
  bool Assign(const Value& value, const char* key, bool& field, const Range&);
  bool Assign(const Value& value, const char* key, std::string& field, const Range&);
  bool Assign(const Value& value, const char* key, std::string& field, const Choices& choices);
  bool Assign(const Value& value, const char* key, Value& field, const Range&);
  /// Arrays, and tables with free keys.
  template <class T>
  bool Assign(const Value& value, const char* key, std::vector<T>& field, const Range& range) {
    if constexpr (std::same_as<T, std::string> || std::same_as<T, Value>) {
      if (!value.is_array()) {  // one item may stand without brackets
        T item;
        field.clear();
        if (!Assign(value, key, item, range)) return false;
        field.push_back(std::move(item));
        return true;
      }
    }
    if (!value.is_array()) return Wrong(value, key, "an array");
    field.clear();
    bool good = true;
    for (const Value& item : value.array()) {
      T one{};
      good = Assign(item, key, one, range) && good;
      field.push_back(std::move(one));
    }
    return good;
  }
  template <class T>
  bool Assign(const Value& value, const char* key, std::vector<std::pair<std::string, T>>& field, const Range& range) {
    if (!value.is_table()) return Wrong(value, key, "a table");
    field.clear();
    bool good = true;
    for (const Value::Entry& entry : value.table()) {
      T one{};
      if constexpr (requires(ParamReader & v) { one.Visit(v); }) {
        good = ReadTable(entry.value, one, fmt::format("{}.{}.{}", context_, key, entry.key)) && good;
      } else {
        good = Assign(entry.value, entry.key.c_str(), one, range) && good;
      }
      field.emplace_back(entry.key, std::move(one));
    }
    return good;
  }
  template <class T>
  bool ReadTable(const Value& table, T& params, const std::string& context);
  bool Wrong(const Value& value, std::string_view key, const std::string& expected);

  const Value& table_;
  Diagnostics& diagnostics_;
  std::string context_;
  std::vector<std::string> asked_, lacking_;  // keys that may stand there; those that have to and do not
  Motion motion_;
  bool ok_ = true;
};

/// Lists the parameters for `describe`.
class ParamLister {
 public:
  template <class T, class Rule>
  void Required(const char* key, T& field, const Rule& rule, const char* description) {
    Add(key, TypeName(field), rule, "", description);
  }
  template <class T, class Rule>
  void Optional(const char* key, T& field, const Rule& rule, const char* description) {
    Add(key, TypeName(field), rule, Text(field), description);
  }
  std::vector<ParamInfo> items;

 private:
  void Add(const char* key, std::string type, const Range& range, std::string fallback, const char* description);
  void Add(const char* key, std::string type, const std::vector<std::string>& choices, std::string fallback,
           const char* description);
  template <class T>
  static std::string TypeName(const T&) {
    if constexpr (std::same_as<T, double>) return "number";
    if constexpr (std::same_as<T, int> || std::same_as<T, std::int64_t>) return "integer";
    if constexpr (std::same_as<T, bool>) return "boolean";
    if constexpr (std::same_as<T, std::string>) return "string";
    if constexpr (std::same_as<T, std::vector<double>>) return "array of numbers";
    if constexpr (std::same_as<T, std::vector<std::string>>) return "array of strings";
    return "table";
  }
  template <class T>
  static std::string Text(const T& field) {
    if constexpr (std::is_arithmetic_v<T>) return fmt::format("{}", field);
    if constexpr (std::same_as<T, std::string>) return "\"" + field + "\"";
    return "none";
  }
};

/// Reads `table` into `params`; true when nothing was wrong.
template <class P>
bool ReadParams(const Value& table, P& params, Diagnostics& diagnostics, const std::string& context,
                std::vector<std::string> known = {}, Motion motion = Motion::kRotation) {
  ParamReader reader(table, diagnostics, context, std::move(known), motion);
  params.Visit(reader);
  reader.Finish();
  if constexpr (requires(Faults & faults) { params.Check(faults); }) {
    if (reader.ok()) {
      const int before = diagnostics.error_count();
      Faults faults(table, diagnostics, context, motion);
      params.Check(faults);
      return diagnostics.error_count() == before;
    }
  }
  return reader.ok();
}

template <class P>
std::vector<ParamInfo> ListParams() {
  ParamLister lister;
  P params;
  params.Visit(lister);
  return lister.items;
}

template <class T>
bool ParamReader::ReadTable(const Value& table, T& params, const std::string& context) {
  if (!table.is_table()) return Wrong(table, context, "a table");
  return ReadParams(table, params, diagnostics_, context, {}, motion_);
}

}  // namespace dynoproof
