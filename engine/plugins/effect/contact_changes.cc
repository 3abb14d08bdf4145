#include "plugins/effect/contact_changes.h"

#include "plugins/effect/plan_edit.h"

namespace dynoproof::effects {
namespace {

std::string LawOf(const Value& shaft) {
  const Value* law = shaft.Find("law");
  return law == nullptr ? "spring_damper" : law->is_string() ? law->string() : "";
}

bool HasUndampedPlay(const Value& shaft) {
  const std::string law = LawOf(shaft);
  return law == "dead_zone" || law == "revised_dead_zone" || law == "phase_plane";
}

/// The shafts of a drive line that `suits` accepts.
template <class Suits>
std::vector<Place> ShaftsThat(const PlantTraits& plant, const Plan& plan, const Suits& suits) {
  std::vector<Place> places;
  if (!plant.drive_line) return places;
  for (const std::string& name : NamesIn(plan, "shaft")) {
    const Value& shaft = *Section(plan, "shaft")->Find(name);
    if (shaft.is_table() && suits(shaft)) places.push_back({"shaft", name, ""});
  }
  return places;
}

Value& ShaftAt(Plan& plan, const Place& place) { return plan.root["plant"]["shaft"][place.name]; }

class BacklashOnShaft : public Effect {
 public:
  BacklashOnShaft() {
    // Worn splines and gears have 1e-4 ... 1e-2 rad; the thesis built 0.096 rad of half play on purpose.
    info_ = {"backlash",
             "T = k (d -+ a) + c w beyond a gap of +-a, phase-plane law; thesis (3.3), (3.4)",
             "a shaft with play where the model has none",
             {{"a", "rad", "half of the play", 0.0, 0.2, 0.0, 1e-3}}};
  }
  // In a resonance, or where no torque was measured, the twist is several times that of the torque at rest.
  Points Starts(const Plan& plan, const Place& place, const Magnitudes& magnitudes) const override {
    const double twist = UsualTwist(plan, place, magnitudes);
    return {{0.03 * twist}, {0.3 * twist}};
  }
  std::vector<Place> Places(const Plan& plan) const override {
    return ShaftsThat(PlantOf(plan), plan, [&plan](const Value& shaft) {
      return LawOf(shaft) == "spring_damper" && NumberIn(plan, shaft, "stiffness_Nm_per_rad") > 0.0;
    });
  }
  void Apply(Plan& plan, const Place& place, const std::vector<double>& parameters) const override {
    Value& shaft = ShaftAt(plan, place);
    Replace(shaft["law"], Value(NumberIn(plan, shaft, "damping_Nms_per_rad") > 0.0 ? "phase_plane" : "dead_zone"));
    shaft[KeyIn(plan, shaft, "half_gap_rad")] = Value(parameters[0]);
  }
};

class GapChangeOfShaft : public Effect {
 public:
  GapChangeOfShaft() {
    info_ = {"gap_change",
             "half gap = nominal (1 + delta)",
             "the nominal gap is off",
             {{"delta", "1", "relative error of the gap", -0.9, 4.0, 0.0, 0.02}}};
  }
  std::vector<Place> Places(const Plan& plan) const override {
    return ShaftsThat(PlantOf(plan), plan,
                      [&plan](const Value& shaft) { return NumberIn(plan, shaft, "half_gap_rad") > 0.0; });
  }
  void Apply(Plan& plan, const Place& place, const std::vector<double>& parameters) const override {
    Value& shaft = ShaftAt(plan, place);
    Value& gap = shaft[KeyIn(plan, shaft, "half_gap_rad")];
    Replace(gap, Value(gap.number() * (1.0 + parameters[0])));
  }
  std::string ScaledParameter(const Place& place) const override {
    return "plant.shaft." + place.name + ".half_gap_rad";
  }
};

class ContactFreeDampingOfShaft : public Effect {
 public:
  ContactFreeDampingOfShaft() {
    // The thesis finds 0.1 on its test bed. 10 brakes 6 g m^2 to a stop within a millisecond: no motion is left to see.
    info_ = {"contact_free_damping",
             "T = c_f w_b inside the gap; thesis (3.5), (3.13)-(3.15)",
             "damping between the two sides of a gap while they do not touch",
             {{"c_f", "N m s/rad", "damping inside the gap", 0.0, 10.0, 0.0, 0.05}}};
  }
  std::vector<Place> Places(const Plan& plan) const override {
    return ShaftsThat(PlantOf(plan), plan, [](const Value& shaft) { return HasUndampedPlay(shaft); });
  }
  void Apply(Plan& plan, const Place& place, const std::vector<double>& parameters) const override {
    Value& shaft = ShaftAt(plan, place);
    Replace(shaft["law"], Value("damped_" + LawOf(shaft)));
    shaft[KeyIn(plan, shaft, "contact_free_damping_Nms_per_rad")] = Value(parameters[0]);
  }
};

}  // namespace

std::unique_ptr<Effect> BacklashEffect() { return std::make_unique<BacklashOnShaft>(); }
std::unique_ptr<Effect> GapChange() { return std::make_unique<GapChangeOfShaft>(); }
std::unique_ptr<Effect> ContactFreeDamping() { return std::make_unique<ContactFreeDampingOfShaft>(); }

}  // namespace dynoproof::effects
