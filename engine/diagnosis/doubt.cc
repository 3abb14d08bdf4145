#include "diagnosis/doubt.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace dynoproof::diagnosis {
namespace {

// What a data sheet or a drawing of such parts is good for: masses and shaft geometry within a percent, dampings, which
// nobody calculates, within ten.
constexpr double kInertiaSpread = 0.01, kStiffnessSpread = 0.01, kDampingSpread = 0.1, kGapSpread = 0.005;
// A record may start while the line turns or is wound up: these priors only keep the normal equations regular.
constexpr double kStartSpeed_rad_per_s = 100.0;

// Pipes are measured on drawings, membranes and springs have data sheets. The start follows the record's first samples
// (StartFromRecord), and with them what a sensor makes of them: a gain that is to be found, a tenth of 5 bar.
constexpr double kVolumeSpread = 0.01, kPreloadSpread = 0.02, kStartPressure_Pa = 5e4;

// Spring and damper of a moved body stand for whatever carries it: fitted values, no data sheet's. assumed: any size is
// as good as another beside an effect that takes its share.
constexpr double kFittedSpread = 1.0;

bool IsNumber(const Value* value) { return value != nullptr && value->is_number() && value->number() != 0.0; }

std::vector<Doubt> PressureDoubts(const Plan& plan) {
  std::vector<Doubt> doubts;
  const auto add = [&](const std::string& path, bool relative, double spread) {
    if (IsNumber(plan.root.FindPath(path))) doubts.push_back({path, relative, spread, !relative, "", "", false});
  };
  const Value* volumes = plan.root.FindPath("plant.volume");
  for (const std::string& name : volumes != nullptr ? KeysOf(*volumes) : std::vector<std::string>{}) {
    add("plant.volume." + name + ".volume_m3", true, kVolumeSpread);
    add("plant.volume." + name + ".start_pressure_Pa", false, kStartPressure_Pa);
  }
  add("plant.mass_kg", true, kInertiaSpread);
  add("plant.stiffness_N_per_m", true, kStiffnessSpread);
  add("plant.damping_Ns_per_m", true, kDampingSpread);
  add("plant.preload_N", true, kPreloadSpread);
  return doubts;
}

}  // namespace

std::vector<Doubt> DoubtsOf(const Plan& plan) {
  std::vector<Doubt> doubts;
  const Value* type = plan.root.FindPath("plant.type");
  const std::string plant = type != nullptr && type->is_string() ? type->string() : "";
  if (plant == "charge_air" || plant == "fuel_gas") return PressureDoubts(plan);
  if (plant == "moved_body") {
    for (const char* path : {"plant.stiffness_N_per_m", "plant.damping_Ns_per_m"}) {
      if (IsNumber(plan.root.FindPath(path))) doubts.push_back({path, true, kFittedSpread, false, "", "", false});
    }
    return doubts;
  }
  if (plant != "drive_line") return doubts;
  const auto relative = [&](const std::string& path, double spread, const char* effect, const std::string& at) {
    if (IsNumber(plan.root.FindPath(path))) doubts.push_back({path, true, spread, false, effect, at, false});
  };
  const Value* nominal = plan.root.FindPath("plant.nominal_torque_Nm");
  const double torque = IsNumber(nominal) ? nominal->number() : 1000.0;
  doubts.push_back({"plant.initial_speed_rad_per_s", false, kStartSpeed_rad_per_s, true, "", "", false});
  const auto names = [&](const char* section) {
    const Value* table = plan.root.FindPath(section);
    return table != nullptr ? KeysOf(*table) : std::vector<std::string>{};
  };
  for (const std::string& name : names("plant.inertia"))
    relative("plant.inertia." + name, kInertiaSpread, "inertia_change", "inertia:" + name);
  for (const auto& [section, kind] : {std::pair("plant.rotor", "rotor"), std::pair("plant.shaft", "shaft")}) {
    for (const std::string& name : names(section)) {
      const std::string path = fmt::format("{}.{}.", section, name), at = fmt::format("{}:{}", kind, name);
      relative(path + "inertia_kg_m2", kInertiaSpread, "inertia_change", at);
      relative(path + "stiffness_Nm_per_rad", kStiffnessSpread, "stiffness_change", at);
      relative(path + "damping_Nms_per_rad", kDampingSpread, "damping_change", at);
      relative(path + "half_gap_rad", kGapSpread, "gap_change", at);
      const Value* stiffness = plan.root.FindPath(path + "stiffness_Nm_per_rad");
      const Value* damping = plan.root.FindPath(path + "damping_Nms_per_rad");
      // A damping that is nominally 0 is a simplification, which a hypothesis of another structure may not inherit. The
      // spread: a thousandth of the critical damping 2 sqrt(k J) for J = 0.1 kg m^2 behind the shaft.
      if (IsNumber(stiffness) && damping != nullptr && damping->is_number() && damping->number() == 0.0) {
        doubts.push_back(
            {path + "damping_Nms_per_rad", false, 0.002 * std::sqrt(0.1 * stiffness->number()), false, "", "", true});
      }
      if (std::string_view(kind) == "shaft" && IsNumber(stiffness))
        doubts.push_back({path + "initial_twist_rad", false, torque / stiffness->number(), true, "", "", false});
    }
  }
  return doubts;
}

double DeviateOf(const Doubt& doubt, double change) { return std::log1p(std::max(change, -0.999)) / doubt.spread; }

double ChangeOf(const Doubt& doubt, double z) { return std::expm1(std::clamp(doubt.spread * z, -7.0, 7.0)); }

DoubtValue ValueOf(const Doubt& doubt, double z, const Plan& plan) {
  const Value* found = plan.root.FindPath(doubt.path);
  const double nominal = found != nullptr && found->is_number() ? found->number() : 0.0;
  if (doubt.relative) return {nominal, nominal * (1.0 + ChangeOf(doubt, z))};
  const double value = nominal + doubt.spread * z;
  return {nominal, doubt.only_wide ? std::max(0.0, value) : value};  // dampings are never negative
}

void ApplyDoubts(const std::vector<Doubt>& doubts, const std::vector<double>& z, Plan& plan) {
  for (std::size_t i = 0; i < doubts.size(); ++i) {
    if (z[i] == 0.0) continue;
    const std::size_t dot = doubts[i].path.rfind('.');
    Value* parent = plan.root.FindPath(doubts[i].path.substr(0, dot));
    if (parent == nullptr || !parent->is_table()) continue;
    const std::string key = doubts[i].path.substr(dot + 1);
    if (doubts[i].relative && parent->Find(key) == nullptr) continue;
    (*parent)[key] = Value(ValueOf(doubts[i], z[i], plan).value);
  }
}

}  // namespace dynoproof::diagnosis
