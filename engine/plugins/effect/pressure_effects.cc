#include "plugins/effect/pressure_effects.h"

#include <algorithm>
#include <functional>
#include <utility>

#include "plugins/effect/plan_edit.h"

namespace dynoproof::effects {
namespace {

/// A number at an entry of [plant.SECTION.NAME]: by nominal value and parameter the new one.
class EntryEffect : public Effect {
 public:
  using Change = std::function<double(double nominal, double parameter)>;
  /// `fallback`: the nominal value where the key is not written. `starts`: empty for the parameter's own.
  EntryEffect(EffectInfo info, std::vector<std::string> sections, std::string key, double fallback, Change change,
              Points starts = {})
      : sections_(std::move(sections)),
        key_(std::move(key)),
        fallback_(fallback),
        change_(std::move(change)),
        starts_(std::move(starts)) {
    info_ = std::move(info);
  }

  Points Starts(const Plan& plan, const Place& place, const Magnitudes& magnitudes) const override {
    return starts_.empty() ? Effect::Starts(plan, place, magnitudes) : starts_;
  }

  std::vector<Place> Places(const Plan& plan) const override {
    std::vector<Place> places;
    const std::vector<std::string>& offered = PlantOf(plan).sections;
    for (const std::string& section : sections_) {
      if (std::find(offered.begin(), offered.end(), section) == offered.end()) continue;
      const Value* entries = plan.root.FindPath("plant." + section);
      if (entries == nullptr || !entries->is_table()) continue;
      for (const Value::Entry& entry : entries->table()) {
        if (entry.value.is_table()) places.push_back({section, entry.key, ""});
      }
    }
    return places;
  }

  void Apply(Plan& plan, const Place& place, const std::vector<double>& parameters) const override {
    Value& entry = plan.root["plant"][place.kind][place.name];
    const Value* written = entry.Find(key_);
    const double nominal = written != nullptr && written->is_number() ? written->number() : fallback_;
    const double changed = change_(nominal, parameters[0]);
    if (written != nullptr || changed != fallback_) Replace(entry[key_], Value(changed));
  }

 private:
  std::vector<std::string> sections_;
  std::string key_;
  double fallback_;
  Change change_;
  Points starts_;
};

double Sum(double nominal, double parameter) { return nominal + parameter; }
double Product(double nominal, double parameter) { return nominal * parameter; }

/// Inputs that move a flap or a valve.
class HysteresisEffect : public Effect {
 public:
  HysteresisEffect() {
    // Linkages of flaps have 0.1 ... 5 % of play; the upper bound is that of pressures, as the unit is the input's.
    info_ = {"actuator_hysteresis",
             "y = y_old limited to u -+ width/2",
             "play between a command and the flap or valve that it moves",
             {{"width", "1", "total play, in the unit of the input", 0.0, 1e7, 0.0, 1.0, true}}};
  }

  // Play that the record does not exceed hides all motion: several sizes, the smallest first.
  Points Starts(const Plan&, const Place& place, const Magnitudes& m) const override {
    const double peak = Magnitudes::Of(m.input_peak, place.name);
    return {{0.01 * peak}, {0.05 * peak}};
  }

  std::vector<Place> Places(const Plan& plan) const override {
    std::vector<Place> places;
    const std::vector<std::string>& linkages = PlantOf(plan).linkages;
    const Value* inputs = plan.root.Find("input");
    if (inputs == nullptr || !inputs->is_table()) return places;
    for (const Value::Entry& entry : inputs->table()) {
      for (const std::string& port : StringsOf(entry.value.Find("to"))) {
        if (std::find(linkages.begin(), linkages.end(), port) != linkages.end())
          places.push_back({"input", entry.key, ""});
      }
    }
    return places;
  }

  void Apply(Plan& plan, const Place& place, const std::vector<double>& parameters) const override {
    Value& input = plan.root["input"][place.name];
    Value::Array chain = ListOf(input.Find("actuator"));
    chain.push_back(Value{{"type", "play"}, {"width", parameters[0]}});
    Replace(input["actuator"], Value(std::move(chain)));
  }
};

}  // namespace

std::unique_ptr<Effect> ActuatorHysteresis() { return std::make_unique<HysteresisEffect>(); }

std::unique_ptr<Effect> FlowAreaError() {
  return std::make_unique<EntryEffect>(EffectInfo{"flow_area_error",
                                                  "A = g A(u); fuel gas: k_q and d_q together",
                                                  "an effective area is off by a factor",
                                                  {{"g", "1", "factor, 1: none", 0.1, 10.0, 1.0, 1.02}}},
                                       std::vector<std::string>{"flap", "valve"}, "area_factor", 1.0, Product,
                                       Points{{1.02}, {0.98}, {0.9}, {1.1}, {0.75}, {1.3}});
}

std::unique_ptr<Effect> Leakage() {
  // From a pinhole of 1 mm^2 up to the largest flap of such an air path.
  return std::make_unique<EntryEffect>(
      EffectInfo{"leakage",
                 "q = A_leak p/sqrt(R theta) Psi(p/p_amb) to ambient",
                 "a volume loses gas",
                 {{"A_leak", "m^2", "effective area of the leak", 0.0, 1e-2, 0.0, 1e-6}}},
      std::vector<std::string>{"volume"}, "leakage_area_m2", 0.0, Sum);
}

std::unique_ptr<Effect> SupplyDroop() {
  // Upper bound: a flow of 0.1 kg/s would take the whole of 10 bar.
  return std::make_unique<EntryEffect>(
      EffectInfo{"supply_droop",
                 "p = p_res - slope q_g",
                 "the supply pressure falls with the flow",
                 {{"slope", "Pa s/kg", "pressure lost for each kg/s", 0.0, 1e7, 0.0, 1e5}}},
      std::vector<std::string>{"reservoir"}, "droop_Pas_per_kg", 0.0, Sum);
}

std::unique_ptr<Effect> ValveStiction() {
  // 1e4 N is the membrane's whole force at 5 bar.
  return std::make_unique<EntryEffect>(EffectInfo{"valve_stiction",
                                                  "F = -F_c sgn(v), sticking when it can hold",
                                                  "dry friction of membrane and rod",
                                                  {{"F_c", "N", "friction force", 0.0, 1e4, 0.0, 1.0}}},
                                       std::vector<std::string>{"valve"}, "friction_N", 0.0, Sum,
                                       // Stiction that the record does not exceed hides all motion.
                                       Points{{2.0}, {10.0}, {40.0}});
}

}  // namespace dynoproof::effects
