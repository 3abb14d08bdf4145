#include "model/motion.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <utility>

namespace dynoproof {
namespace {

using Pair = std::pair<std::string_view, std::string_view>;  // of rotation, of translation

constexpr auto kUnits = std::to_array<Pair>({{"N m/rad^3", "N/m^3"},
                                             {"N m/rad", "N/m"},
                                             {"N m s^2/rad^2", "N s^2/m^2"},
                                             {"N m s/rad", "N s/m"},
                                             {"kg m^2", "kg"},
                                             {"rad/s", "m/s"},
                                             {"N m/s", "N/s"},
                                             {"N m", "N"},
                                             {"rad", "m"}});

// A suffix that ends in another one stands before it.
constexpr auto kSuffixes = std::to_array<Pair>({{"theta_rad", "theta_rad"},  // a phase is an angle in either motion
                                                {"_Nm_per_rad3", "_N_per_m3"},
                                                {"_Nm_per_rad", "_N_per_m"},
                                                {"_Nms2_per_rad2", "_Ns2_per_m2"},
                                                {"_Nms_per_rad", "_Ns_per_m"},
                                                {"_per_rad", "_per_m"},
                                                {"_kg_m2", "_kg"},
                                                {"_rad_per_s", "_m_per_s"},
                                                {"_Nm", "_N"},
                                                {"_rad", "_m"}});

constexpr auto kWords =
    std::to_array<Pair>({{"inertia", "mass"}, {"torque", "force"}, {"twist", "stretch"}, {"angle", "position"}});

/// One word of a name, between underscores.
std::string_view Word(std::string_view word) {
  for (const auto& [turning, sliding] : kWords) {
    if (word == turning) return sliding;
  }
  return word;
}

bool IsOfAName(char c) { return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_'; }

}  // namespace

Motion MotionOf(const Value& plant) {
  return plant.TextOr("motion") == "translation" ? Motion::kTranslation : Motion::kRotation;
}

Motion MotionIn(const Value& root) {
  const Value* plant = root.Find("plant");
  return plant != nullptr ? MotionOf(*plant) : Motion::kRotation;
}

bool IsForce(std::string_view unit) { return unit == "N m" || unit == "N"; }

bool IsSpeed(std::string_view unit) { return unit == "rad/s" || unit == "m/s"; }

std::string UnitIn(Motion motion, std::string_view unit) {
  for (const auto& [turning, sliding] : kUnits) {
    if (motion == Motion::kTranslation && unit == turning) return std::string(sliding);
  }
  return std::string(unit);
}

std::string NameIn(Motion motion, std::string_view name) {
  if (motion == Motion::kRotation) return std::string(name);
  std::string_view suffix;
  for (const auto& [turning, sliding] : kSuffixes) {
    if (!name.ends_with(turning)) continue;
    name.remove_suffix(turning.size());
    suffix = sliding;
    break;
  }
  std::string result;
  while (!name.empty()) {
    const std::size_t end = std::min(name.find('_'), name.size());
    result += Word(name.substr(0, end));
    if (end < name.size()) result += '_';
    name.remove_prefix(std::min(end + 1, name.size()));
  }
  return result.append(suffix);
}

std::string KeyIn(Motion motion, const Value& table, std::string_view key) {
  if (key.find('_') == std::string_view::npos) return std::string(key);  // a section, which keeps its name
  std::string own = NameIn(motion, key);
  return table.Find(own) == nullptr && table.Find(key) != nullptr ? std::string(key) : own;
}

std::string TextIn(Motion motion, std::string_view text) {
  if (motion == Motion::kRotation) return std::string(text);
  std::string result;
  while (!text.empty()) {
    std::size_t end = 0;
    while (end < text.size() && IsOfAName(text[end])) ++end;
    result += NameIn(motion, text.substr(0, end));
    if (end < text.size()) result += text[end++];
    text.remove_prefix(end);
  }
  return result;
}

}  // namespace dynoproof
