// A scenario as data: a tree of values, each of which knows where it was written. TOML is only its notation; everything
// above reads and edits this tree, so that a fit, a hidden truth and a hand-made change take the same way.
#pragma once

#include <cstdint>
#include <initializer_list>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include "base/diagnostics.h"

namespace dynoproof {

class Value {
 public:
  struct Entry;
  using Array = std::vector<Value>;
  using Table = std::vector<Entry>;  // in the order of writing; keys are unique

  // Literals read well where a value is wanted: the conversions are implicit. NOLINTBEGIN(google-explicit-constructor)
  Value();
  Value(bool value);
  Value(int value);
  Value(std::int64_t value);
  Value(double value);
  Value(const char* value);
  Value(std::string value);
  Value(Array value);
  // NOLINTEND(google-explicit-constructor)
  Value(std::initializer_list<std::pair<const char*, Value>> entries);

  bool is_table() const { return std::holds_alternative<Table>(data_); }
  bool is_array() const { return std::holds_alternative<Array>(data_); }
  bool is_string() const { return std::holds_alternative<std::string>(data_); }
  bool is_bool() const { return std::holds_alternative<bool>(data_); }
  bool is_integer() const { return std::holds_alternative<std::int64_t>(data_); }
  /// Integers count as numbers.
  bool is_number() const { return std::holds_alternative<double>(data_) || is_integer(); }
  /// "a table", "a string", "an integer", ... for messages.
  std::string KindName() const;

  const Table& table() const { return std::get<Table>(data_); }
  Table& table() { return std::get<Table>(data_); }
  const Array& array() const { return std::get<Array>(data_); }
  Array& array() { return std::get<Array>(data_); }
  const std::string& string() const { return std::get<std::string>(data_); }
  bool boolean() const { return std::get<bool>(data_); }
  std::int64_t integer() const { return std::get<std::int64_t>(data_); }
  double number() const { return is_integer() ? static_cast<double>(integer()) : std::get<double>(data_); }

  /// The entry of a table; null when this is no table or has no such key.
  const Value* Find(std::string_view key) const;
  Value* Find(std::string_view key);
  /// The entry of that key, made (as an empty table) when missing. This must be a table.
  Value& operator[](std::string_view key);
  void Erase(std::string_view key);
  /// The value at a dotted path such as "plant.inertia.I5" or "output.T_shaft.sensor.0.gain" (array items by number).
  const Value* FindPath(std::string_view path) const;
  Value* FindPath(std::string_view path);
  /// The number or text at a dotted path; `fallback` where there is nothing or something else.
  double NumberOr(std::string_view path, double fallback) const;
  std::string TextOr(std::string_view path, std::string_view fallback = "") const;

  const SourceSpan& where() const { return where_; }
  void set_where(SourceSpan where) { where_ = std::move(where); }

 private:
  std::variant<bool, std::int64_t, double, std::string, Array, Table> data_;
  SourceSpan where_;
};

struct Value::Entry {
  std::string key;
  Value value;
  SourceSpan where;  // of the key
};

// Here, because making a variant of tables takes complete entries.
inline Value::Value() : data_(Table{}) {}
inline Value::Value(bool value) : data_(value) {}
inline Value::Value(int value) : data_(std::int64_t{value}) {}
inline Value::Value(std::int64_t value) : data_(value) {}
inline Value::Value(double value) : data_(value) {}
inline Value::Value(const char* value) : data_(std::string(value)) {}
inline Value::Value(std::string value) : data_(std::move(value)) {}
inline Value::Value(Array value) : data_(std::move(value)) {}

/// The names of a table's keys, or of nothing for other values.
std::vector<std::string> KeysOf(const Value& value);

/// Takes every entry of `patch` over into `base`; tables merge, all else is replaced.
void MergeInto(Value& base, const Value& patch);

}  // namespace dynoproof
