#include "plugins/effect/plan_edit.h"

#include <fmt/format.h>

#include <algorithm>

#include "model/motion.h"

namespace dynoproof::effects {
namespace {

constexpr const char* kSections[] = {"inertia", "rotor", "shaft", "load", "torque", "run"};

}  // namespace

const Value* DriveLineOf(const Plan& plan) {
  const Value* plant = plan.root.Find("plant");
  if (plant == nullptr) return nullptr;
  // A plan is edited before it is built, so before the plant has checked it: what is no table is left to that check.
  for (const char* section : kSections) {
    const Value* table = plant->Find(section);
    if (table != nullptr && !table->is_table()) return nullptr;
  }
  return plant;
}

const Value* Section(const Plan& plan, std::string_view name) {
  const Value* plant = DriveLineOf(plan);
  const Value* section = plant != nullptr ? plant->Find(name) : nullptr;
  return section != nullptr && section->is_table() ? section : nullptr;
}

std::vector<std::string> NamesIn(const Plan& plan, std::string_view section) {
  const Value* table = Section(plan, section);
  return table != nullptr ? KeysOf(*table) : std::vector<std::string>();
}

std::string KeyIn(const Plan& plan, const Value& table, std::string_view key) {
  return dynoproof::KeyIn(MotionIn(plan.root), table, key);
}

double NumberAt(const Plan& plan, const std::string& path, double otherwise) {
  const Value* value = plan.root.FindPath(path);
  return value != nullptr && value->is_number() ? value->number() : otherwise;
}

double NumberIn(const Plan& plan, const Value& table, std::string_view key, double otherwise) {
  const Value* value = table.Find(KeyIn(plan, table, key));
  return value != nullptr && value->is_number() ? value->number() : otherwise;
}

double NumberOfShaft(const Plan& plan, const Place& shaft, std::string_view key, double otherwise) {
  const Value* table = plan.root.FindPath("plant.shaft." + shaft.name);
  return table != nullptr ? NumberIn(plan, *table, key, otherwise) : otherwise;
}

double StiffnessAt(const Plan& plan, const Place& shaft) {
  return NumberOfShaft(plan, shaft, "stiffness_Nm_per_rad", 0.0);
}

double UsualTwist(const Plan& plan, const Place& shaft, const Magnitudes& magnitudes) {
  const double k = StiffnessAt(plan, shaft);
  return k > 0.0 ? magnitudes.torque / k : 1e-3;
}

Value::Array ListOf(const Value* value) {
  if (value == nullptr) return {};
  return value->is_array() ? value->array() : Value::Array{*value};
}

std::vector<std::string> StringsOf(const Value* value) {
  std::vector<std::string> texts;
  for (const Value& item : ListOf(value)) {
    if (item.is_string()) texts.push_back(item.string());
  }
  return texts;
}

bool IsAt(std::string_view end, std::string_view body) {
  if (!end.starts_with(body)) return false;
  const std::string_view rest = end.substr(body.size());
  return rest.empty() || rest == ".left" || rest == ".right";
}

void Replace(Value& value, Value by) {
  by.set_where(value.where());
  value = std::move(by);
}

void InsertAfter(Value& table, std::string_view after, const std::string& key, Value value) {
  Value::Table& entries = table.table();
  auto place = std::find_if(entries.begin(), entries.end(), [&](const Value::Entry& e) { return e.key == after; });
  if (place != entries.end()) ++place;
  entries.insert(place, {key, std::move(value), {}});
}

std::string FreeName(const std::string& wish, const std::vector<std::string>& taken) {
  std::string name = wish;
  for (int i = 2; std::find(taken.begin(), taken.end(), name) != taken.end(); ++i) name = fmt::format("{}_{}", wish, i);
  return name;
}

std::vector<std::string> AllNames(const Plan& plan) {
  std::vector<std::string> all;
  for (const char* section : kSections) {
    const Value* table = plan.root.FindPath(std::string("plant.") + section);
    if (table == nullptr || !table->is_table()) continue;
    for (std::string& name : KeysOf(*table)) all.push_back(std::move(name));
  }
  return all;
}

}  // namespace dynoproof::effects
