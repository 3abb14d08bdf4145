#include "plugins/effect/coupling_effects.h"

#include <limits>

#include "plugins/effect/plan_edit.h"

namespace dynoproof::effects {
namespace {

/// Shafts with law kelvin_voigt that has no drift yet.
std::vector<Place> Couplings(const PlantTraits& plant, const Plan& plan, bool damped) {
  std::vector<Place> places;
  if (!plant.drive_line) return places;
  for (const std::string& name : NamesIn(plan, "shaft")) {
    const Value& shaft = *Section(plan, "shaft")->Find(name);
    const Value* law = shaft.Find("law");
    if (law == nullptr || !law->is_string() || law->string() != "kelvin_voigt" || shaft.Find("drift") != nullptr)
      continue;
    if (damped && !(NumberIn(plan, shaft, "damping_Nms_per_rad") > 0.0)) continue;
    places.push_back({"shaft", name, ""});
  }
  return places;
}

class OilDynamicsEffect : public Effect {
 public:
  OilDynamicsEffect() {
    // Couplings of 1e3 ... 1e7 N m/rad; oil that evens out within 0.1 ms ... 10 s. Starts: Table 4.2, rounded.
    info_ = {"oil_dynamics",
             "T = k_s d + k_p p, dp/dt = -kappa_p p + kappa_w w",
             "the oil of a hydrodynamic coupling has dynamics of its own",
             {{"k_s", "N m/rad", "stiffness of the spring packs", 1e3, 1e7, kShape, 8e4},
              {"kappa_p", "1/s", "decay of the oil's pressure drop", 0.1, 1e4, kShape, 200.0},
              {"k_p_kappa_w", "N m/rad", "stiffness that closed-in oil adds", 1e3, 1e8, kShape, 1.5e5}}};
  }

  std::vector<Place> Places(const Plan& plan) const override { return Couplings(PlantOf(plan), plan, false); }
  Points Starts(const Plan& plan, const Place& place, const Magnitudes&) const override {
    const double k = StiffnessAt(plan, place);
    const double c = NumberOfShaft(plan, place, "damping_Nms_per_rad", 500.0);
    Points starts;
    for (const double kappa : {60.0, 200.0, 600.0}) starts.push_back({0.9 * k, kappa, c * kappa});
    return starts;
  }

  void Apply(Plan& plan, const Place& place, const std::vector<double>& parameters) const override {
    Value& shaft = plan.root["plant"]["shaft"][place.name];
    Replace(shaft["law"], Value("oil_coupling"));
    Replace(shaft[KeyIn(plan, shaft, "stiffness_Nm_per_rad")], Value(parameters[0]));
    shaft.Erase(KeyIn(plan, shaft, "damping_Nms_per_rad"));
    shaft["k_p_m3"] = Value(1.0);
    shaft["kappa_p_per_s"] = Value(parameters[1]);
    shaft[KeyIn(plan, shaft, "kappa_w_Pa_per_rad")] = Value(parameters[2]);
  }
};

class ViscosityDriftEffect : public Effect {
 public:
  ViscosityDriftEffect() {
    // Oil warms up within seconds under heavy load and within an hour in a cold hall.
    info_ = {"viscosity_drift",
             "c (1 - delta (1 - exp(-t/tau)))",
             "the damping falls with running time as the oil warms up",
             {{"delta", "1", "share of the damping that is lost in the end", 0.0, 1.0, 0.0, 0.1},
              {"tau", "s", "time constant of that", 0.01, 1e4, kShape, 1.0}}};
  }

  std::vector<Place> Places(const Plan& plan) const override { return Couplings(PlantOf(plan), plan, true); }
  Points Starts(const Plan&, const Place&, const Magnitudes& m) const override {
    return {{0.2, 0.05 * m.duration_s}, {0.2, 0.2 * m.duration_s}, {0.2, 0.7 * m.duration_s}};
  }

  void Apply(Plan& plan, const Place& place, const std::vector<double>& parameters) const override {
    Value& shaft = plan.root["plant"]["shaft"][place.name];
    shaft["drift"] = Value(parameters[0]);
    shaft["drift_time_s"] = Value(parameters[1]);
  }
};

}  // namespace

std::unique_ptr<Effect> OilDynamics() { return std::make_unique<OilDynamicsEffect>(); }

std::unique_ptr<Effect> ViscosityDrift() { return std::make_unique<ViscosityDriftEffect>(); }

}  // namespace dynoproof::effects
