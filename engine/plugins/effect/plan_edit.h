// How effects read and edit a plan: lookups that never fail, edits that keep the order and the source places.
// The layout of a drive line's scenario is in engine/plugins/plant/drive_line/README.md.
#pragma once

#include <limits>
#include <string>
#include <string_view>
#include <vector>

#include "model/effect.h"

namespace dynoproof::effects {

/// The neutral value of a shape parameter: it has none.
inline constexpr double kShape = std::numeric_limits<double>::quiet_NaN();

/// The table [plant] when the sections of a drive line in it are tables, else null. Whether the plant is one at all its
/// traits say.
const Value* DriveLineOf(const Plan& plan);
/// The section [plant.`name`] of a drive line, as a table; null when there is none.
const Value* Section(const Plan& plan, std::string_view name);
/// The keys of that section.
std::vector<std::string> NamesIn(const Plan& plan, std::string_view section);

/// A key of rotation as this plan has it in that table of its plant, whose bodies may slide.
std::string KeyIn(const Plan& plan, const Value& table, std::string_view key);
/// The number at a path, `otherwise` where there is none.
double NumberAt(const Plan& plan, const std::string& path, double otherwise);
/// The number of a table of the plant by its key of rotation; `otherwise` where the table has none.
double NumberIn(const Plan& plan, const Value& table, std::string_view key, double otherwise = 0.0);
/// The same of the table of a drive line's shaft.
double NumberOfShaft(const Plan& plan, const Place& shaft, std::string_view key, double otherwise);
/// The stiffness of a drive line's shaft [N m/rad, or N/m], 0 where none is written.
double StiffnessAt(const Plan& plan, const Place& shaft);
/// The twist of that shaft under the record's torque [rad, or m].
double UsualTwist(const Plan& plan, const Place& shaft, const Magnitudes& magnitudes);

/// A list that may stand as a single item without brackets.
Value::Array ListOf(const Value* value);
/// The strings of such a list.
std::vector<std::string> StringsOf(const Value* value);
/// True when a shaft's end names that body: "I1", "I1.left" and "I1.right" are at I1.
bool IsAt(std::string_view end, std::string_view body);

/// Replaces a value and keeps the place it was written at.
void Replace(Value& value, Value by);
/// Inserts an entry behind `after`, or at the end when there is no such key.
void InsertAfter(Value& table, std::string_view after, const std::string& key, Value value);
/// `wish`, or with _2, _3, ... behind it when a list has it already.
std::string FreeName(const std::string& wish, const std::vector<std::string>& taken);
/// Every name of a body, shaft, load, torque entry or run: outputs name all of them alike, so new ones must differ.
std::vector<std::string> AllNames(const Plan& plan);

}  // namespace dynoproof::effects
