#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "plugins/plant/drive_line/drive_line.h"

namespace dynoproof {
namespace {

// What a data sheet or a drawing of such parts is good for: masses and shaft geometry within a percent, dampings, which
// nobody calculates, within ten.
constexpr double kInertiaSpread = 0.01, kStiffnessSpread = 0.01, kDampingSpread = 0.1, kGapSpread = 0.005;
// A record may start while the line turns or is wound up: these priors only keep the normal equations regular.
constexpr double kStartSpeed_rad_per_s = 100.0, kStartTorque_Nm = 1000.0, kStartAngle_rad = 100.0;

std::vector<std::string> NamesIn(const Plan& plan, const char* section) {
  const Value* table = plan.root.FindPath(section);
  return table != nullptr ? KeysOf(*table) : std::vector<std::string>();
}

/// Whether an output is an angle. In all others the angle at which a line starts is not to be seen.
bool ShowsAngle(const Plan& plan) {
  const Value* outputs = plan.root.Find("output");
  if (outputs == nullptr || !outputs->is_table()) return false;
  return std::ranges::any_of(outputs->table(), [](const Value::Entry& entry) {
    const Value* of = entry.value.Find("of");
    return of != nullptr && of->is_string() &&
           (of->string().ends_with(".angle") || of->string().ends_with(".position"));
  });
}

/// The number at a path that is there and not 0.
std::optional<double> NumberAt(const Plan& plan, const std::string& path) {
  const Value* value = plan.root.FindPath(path);
  return value != nullptr && value->is_number() && value->number() != 0.0 ? std::optional(value->number())
                                                                          : std::nullopt;
}

std::vector<NuisanceParameter> Nuisances(const Plan& plan) {
  const Motion motion = MotionIn(plan.root);
  // The path of a key of rotation in the table that is at `path`, or would be.
  const auto key = [&](const std::string& path, std::string_view name) {
    static const Value none;
    const Value* table = plan.root.FindPath(path);
    return path + "." + KeyIn(motion, table != nullptr ? *table : none, name);
  };
  const double torque = NumberAt(plan, key("plant", "nominal_torque_Nm")).value_or(kStartTorque_Nm);
  std::vector<NuisanceParameter> nuisances = {{key("plant", "initial_speed_rad_per_s"), false, kStartSpeed_rad_per_s,
                                               "a record may start while the line turns", true}};
  if (ShowsAngle(plan)) {
    nuisances.push_back({key("plant", "initial_angle_rad"), false, kStartAngle_rad,
                         "a record may start at any angle of the encoder", true, true});
  }
  for (const std::string& name : NamesIn(plan, "plant.inertia"))
    nuisances.push_back({"plant.inertia." + name, true, kInertiaSpread, "a drawing's mass and geometry"});
  for (const char* section : {"plant.rotor", "plant.shaft"}) {
    for (const std::string& name : NamesIn(plan, section)) {
      const std::string path = fmt::format("{}.{}", section, name);
      nuisances.push_back({key(path, "inertia_kg_m2"), true, kInertiaSpread, "a drawing's mass and geometry"});
      nuisances.push_back({key(path, "stiffness_Nm_per_rad"), true, kStiffnessSpread, "a drawing's geometry"});
      nuisances.push_back({key(path, "damping_Nms_per_rad"), true, kDampingSpread, "nobody calculates dampings"});
      nuisances.push_back({key(path, "half_gap_rad"), true, kGapSpread, "a gap that was measured"});
      const std::optional<double> stiffness = NumberAt(plan, key(path, "stiffness_Nm_per_rad"));
      if (!stiffness) continue;
      if (std::string_view(section) != "plant.shaft") continue;
      nuisances.push_back({key(path, "initial_twist_rad"), false, torque / *stiffness,
                           "a record may start while the line is wound up", true});
      nuisances.push_back({key(path, "initial_twist_rate_rad_per_s"), false, kStartSpeed_rad_per_s,
                           "a record may start while the line swings", true, true});
    }
  }
  const std::vector<NuisanceParameter> loads = LoadSizes(plan);
  nuisances.insert(nuisances.end(), loads.begin(), loads.end());
  return nuisances;
}

std::vector<Place> Bodies(const Plan& plan) {
  std::vector<Place> places;
  for (const char* kind : {"inertia", "rotor"}) {
    const Value* table = plan.root.FindPath(std::string("plant.") + kind);
    for (const std::string& name : table != nullptr ? KeysOf(*table) : std::vector<std::string>())
      places.push_back({kind, name, ""});
  }
  return places;
}

}  // namespace

PlantTraits DriveLine::Traits() {
  PlantTraits traits;
  traits.nuisances = Nuisances;
  traits.drive_line = true;
  traits.bodies = Bodies;
  return traits;
}

}  // namespace dynoproof
