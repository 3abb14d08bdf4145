#include "model/params.h"

#include <algorithm>
#include <cstdint>
#include <iterator>

namespace dynoproof {

std::string Range::ToString() const {
  const bool below = std::isfinite(lower), above = std::isfinite(upper);
  if (below && above) return fmt::format("{} ... {}", lower, upper);
  if (below) return fmt::format("{} {}", open ? ">" : ">=", lower);
  if (above) return fmt::format("<= {}", upper);
  return "any";
}

void Faults::At(std::string_view key, std::string_view message, std::string_view hint) {
  const Value* value = table_.Find(KeyIn(motion_, table_, key));
  diagnostics_.Error(value != nullptr ? value->where() : table_.where(), context_ + ": " + TextIn(motion_, message),
                     TextIn(motion_, hint));
}

ParamReader::ParamReader(const Value& table, Diagnostics& diagnostics, std::string context,
                         std::vector<std::string> known, Motion motion)
    : table_(table),
      diagnostics_(diagnostics),
      context_(std::move(context)),
      asked_(std::move(known)),
      motion_(motion) {}

const Value* ParamReader::Take(const char* key, const std::string& rule, bool required, const char* description) {
  asked_.emplace_back(key);
  const Value* value = table_.Find(key);
  if (value == nullptr && required && table_.is_table()) {  // of no table Finish() says so, once
    ok_ = false;
    lacking_.emplace_back(key);
    diagnostics_.Error(table_.where(),
                       fmt::format("{} needs the key \"{}\" ({})", context_, key, TextIn(motion_, description)),
                       fmt::format("add {} = ... [{}]", key, rule), "");
  }
  return value;
}

std::string ParamReader::RuleText(const char* key, const Range& range) const {
  const std::string unit = range.unit.empty() ? UnitOfSuffix(key) : UnitIn(motion_, range.unit);
  return unit.empty() || unit == "1" ? range.ToString() : fmt::format("{}, {}", unit, range.ToString());
}

std::string ParamReader::RuleText(const char*, const Choices& choices) {
  return fmt::format("one of {}", fmt::join(choices, ", "));
}

void ParamReader::Finish() {
  if (!table_.is_table()) {
    ok_ = false;
    diagnostics_.Error(table_.where(), fmt::format("{} is {}", context_, table_.KindName()), "write a table");
    return;
  }
  for (const Value::Entry& entry : table_.table()) {
    if (std::find(asked_.begin(), asked_.end(), entry.key) != asked_.end()) continue;
    ok_ = false;
    std::vector<std::string> missing;  // a key that is written already is not what was meant
    std::copy_if(asked_.begin(), asked_.end(), std::back_inserter(missing),
                 [this](const std::string& key) { return table_.Find(key) == nullptr; });
    std::optional<std::string> near = Closest(entry.key, missing);
    if (!near) near = Closest(entry.key, asked_);
    if (!near && lacking_.size() == 1) near = lacking_.front();  // what has to stand there is most likely what this is
    std::vector<std::string> sorted = asked_;
    std::sort(sorted.begin(), sorted.end());
    const std::string hint =
        near ? fmt::format("did you mean \"{}\"?", *near) : fmt::format("known keys: {}", fmt::join(sorted, ", "));
    diagnostics_.Error(entry.where, fmt::format("unknown key \"{}\" in {}", entry.key, context_), hint, "");
  }
}

bool ParamReader::Wrong(const Value& value, std::string_view key, const std::string& expected) {
  diagnostics_.Error(value.where(), fmt::format("\"{}\" in {} is {}", key, context_, value.KindName()),
                     fmt::format("write {}", expected), "");
  return false;
}

bool ParamReader::Assign(const Value& value, const char* key, double& field, const Range& range) {
  if (!value.is_number()) return Wrong(value, key, "a number");
  if (!range.Contains(value.number())) {
    diagnostics_.Error(value.where(), fmt::format("\"{}\" in {} is {}, out of range", key, context_, value.number()),
                       std::isfinite(value.number()) || range.ToString() != "any"
                           ? fmt::format("allowed: {}", RuleText(key, range))
                           : "write a finite number",
                       "");
    return false;
  }
  field = value.number();
  return true;
}

bool ParamReader::Assign(const Value& value, const char* key, std::int64_t& field, const Range& range) {
  if (!value.is_integer()) return Wrong(value, key, "an integer");
  double number = 0.0;
  if (!Assign(value, key, number, range)) return false;
  field = value.integer();
  return true;
}

bool ParamReader::Assign(const Value& value, const char* key, int& field, const Range& range) {
  std::int64_t wide = 0;
  Range narrow = range;
  narrow.lower = std::max(range.lower, static_cast<double>(std::numeric_limits<int>::min()));
  narrow.upper = std::min(range.upper, static_cast<double>(std::numeric_limits<int>::max()));
  if (!Assign(value, key, wide, narrow)) return false;
  field = static_cast<int>(wide);
  return true;
}

bool ParamReader::Assign(const Value& value, const char* key, bool& field, const Range&) {
  if (!value.is_bool()) return Wrong(value, key, "true or false");
  field = value.boolean();
  return true;
}

bool ParamReader::Assign(const Value& value, const char* key, std::string& field, const Range&) {
  if (!value.is_string()) return Wrong(value, key, "a string");
  field = value.string();
  return true;
}

bool ParamReader::Assign(const Value& value, const char* key, std::string& field, const Choices& choices) {
  if (!Assign(value, key, field, Range{})) return false;
  if (std::find(choices.begin(), choices.end(), field) != choices.end()) return true;
  const std::optional<std::string> near = Closest(field, choices);
  diagnostics_.Error(value.where(), fmt::format("\"{}\" in {} cannot be \"{}\"", key, context_, field),
                     near ? fmt::format("did you mean \"{}\"?", *near) : RuleText(key, choices), "");
  return false;
}

bool ParamReader::Assign(const Value& value, const char*, Value& field, const Range&) {
  field = value;
  return true;
}

void ParamLister::Add(const char* key, std::string type, const Range& range, std::string fallback,
                      const char* description) {
  const bool number = type == "number" || type == "integer" || type == "array of numbers" || type == "table";
  items.push_back({key, std::move(type), number ? (range.unit.empty() ? UnitOfSuffix(key) : range.unit) : "",
                   number ? range.ToString() : "", std::move(fallback), description});
}

void ParamLister::Add(const char* key, std::string type, const std::vector<std::string>& choices, std::string fallback,
                      const char* description) {
  items.push_back(
      {key, std::move(type), "", fmt::format("{}", fmt::join(choices, " | ")), std::move(fallback), description});
}

}  // namespace dynoproof
