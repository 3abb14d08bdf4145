// Turning or sliding. The equations of a line of bodies are the same for both; the units are not, nor are the keys that carry
// them as suffixes: stiffness_Nm_per_rad of a shaft is stiffness_N_per_m of a spring. Plugins are written in the keys of
// rotation, and read and write a plan through KeyIn().
#pragma once

#include <string>
#include <string_view>

#include "model/value.h"

namespace dynoproof {

enum class Motion { kRotation, kTranslation };

/// Translation where the table [plant] has motion = "translation", else rotation.
Motion MotionOf(const Value& plant);
/// The motion of the plant of a whole scenario; rotation where it has none.
Motion MotionIn(const Value& root);

/// Whether a unit is that of a torque or of a force, and whether it is that of a speed, of whichever motion.
bool IsForce(std::string_view unit);
bool IsSpeed(std::string_view unit);

/// A unit of rotation as that of the same quantity in this motion: "N m/rad" is "N/m" in translation. Units that hold for
/// both stay.
std::string UnitIn(Motion motion, std::string_view unit);

/// A key, or the name of a port, of rotation as it is called in this motion: "initial_twist_rad" is "initial_stretch_m" in
/// translation, "torque" is "force".
std::string NameIn(Motion motion, std::string_view name);

/// The same for a key of that table. Where only the key of rotation is written it is meant: the number is the same.
std::string KeyIn(Motion motion, const Value& table, std::string_view key);

/// Every key of rotation that a text mentions, as NameIn() has it.
std::string TextIn(Motion motion, std::string_view text);

}  // namespace dynoproof
