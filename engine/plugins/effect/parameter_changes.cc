#include "plugins/effect/parameter_changes.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "plugins/effect/plan_edit.h"

namespace dynoproof::effects {
namespace {

class Scaled : public Effect {
 public:
  /// `kinds`: the kinds of place; `key`: the value's key there, which a lumped inertia or a parameter (a bare number) does not need.
  Scaled(std::string name, std::string what, double upper, std::vector<std::string> kinds, std::string key,
         Points starts)
      : kinds_(std::move(kinds)), key_(std::move(key)), starts_(std::move(starts)) {
    // Below 10 % of the nominal value the model is wrong in kind, not in a number. The start is off 0 by what a data
    // sheet is usually off by, so that a relative step of a fit changes something.
    info_ = {std::move(name),
             fmt::format("{} = nominal (1 + delta)", what),
             fmt::format("the nominal {} is off", what),
             {{"delta", "1", fmt::format("relative error of the {}", what), -0.9, upper, 0.0, 0.02}}};
  }

  std::vector<Place> Places(const Plan& plan) const override {
    std::vector<Place> places;
    const PlantTraits& plant = PlantOf(plan);
    for (const std::string& kind : kinds_) {
      if (!plant.drive_line && std::ranges::count(plant.sections, kind) == 0) continue;
      for (const std::string& name : NamesIn(plan, kind)) {
        const Value* value = plan.root.FindPath(ScaledIn(plan, {kind, name, ""}));
        if (value != nullptr && value->is_number() && value->number() != 0.0) places.push_back({kind, name, ""});
      }
    }
    return places;
  }

  void Apply(Plan& plan, const Place& place, const std::vector<double>& parameters) const override {
    Value* value = plan.root.FindPath(ScaledIn(plan, place));
    if (value == nullptr) return;  // not one of Places()
    Replace(*value, Value(value->number() * (1.0 + parameters[0])));
  }

  Points Starts(const Plan&, const Place&, const Magnitudes&) const override { return starts_; }

  std::string ScaledParameter(const Place& place) const override {
    const bool is_number = place.kind == "inertia" || place.kind == "parameter";
    return fmt::format("plant.{}.{}{}{}", place.kind, place.name, is_number ? "" : ".", is_number ? "" : key_);
  }

 private:
  std::vector<std::string> kinds_;
  std::string key_;
  Points starts_;
};

// Far off too: a resonance that moved by more than its width leaves no slope to follow.
Points MovedResonance() { return {{0.02}, {-0.5}, {-0.3}, {-0.2}, {-0.1}, {0.1}, {0.2}, {0.35}, {0.6}, {1.0}}; }

}  // namespace

std::unique_ptr<Effect> InertiaChange() {
  // A flange or a coupling left on can double a small inertia and more.
  return std::make_unique<Scaled>("inertia_change", "inertia", 4.0, std::vector<std::string>{"inertia", "rotor"},
                                  "inertia_kg_m2", MovedResonance());
}

std::unique_ptr<Effect> StiffnessChange() {
  return std::make_unique<Scaled>("stiffness_change", "stiffness", 4.0, std::vector<std::string>{"shaft", "rotor"},
                                  "stiffness_Nm_per_rad", MovedResonance());
}

std::unique_ptr<Effect> DampingChange() {
  // Dampings are the least known numbers of a drive line: the thesis finds 5.5 beside 125 N m s/rad on one line (A.7).
  return std::make_unique<Scaled>("damping_change", "damping", 49.0, std::vector<std::string>{"shaft", "rotor"},
                                  "damping_Nms_per_rad", Points{{0.2}, {2.0}});
}

std::unique_ptr<Effect> ParameterChange() {
  return std::make_unique<Scaled>("parameter_change", "parameter", 4.0, std::vector<std::string>{"parameter"}, "",
                                  MovedResonance());
}

}  // namespace dynoproof::effects
