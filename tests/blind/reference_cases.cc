#include "tests/blind/reference_cases.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "experiment/prepare.h"
#include "scenario/find.h"
#include "scenario/load.h"
#include "score/series.h"
#include "sim/simulate.h"
#include "tests/blind/inexact.h"

namespace dynoproof::blind {
namespace {

/// FullStrength() for plants of pressures: `swing` and `peak` are what the signal at the place swings by, and how far
/// it goes.
std::optional<std::vector<double>> PressureStrength(const std::string& name, bool air, double u, double sign,
                                                    double swing, double peak, double duration_s) {
  if (name == "leakage") return std::vector<double>{(air ? 4e-5 : 2e-6) * u};
  if (name == "flow_area_error") return std::vector<double>{1.0 + 0.08 * u * sign};
  if (name == "actuator_hysteresis") return std::vector<double>{0.4 * swing * u};
  if (name == "valve_stiction") return std::vector<double>{8.0 * u};
  if (name == "supply_droop") return std::vector<double>{1e6 * u};
  if (name == "actuator_lag" || name == "sensor_lag") return std::vector<double>{(air ? 0.3 : 5e-3) * u};
  if (name == "actuator_delay" || name == "sensor_delay") return std::vector<double>{(air ? 0.2 : 5e-3) * u};
  if (name == "actuator_saturation") return std::vector<double>{peak - 0.8 * swing * u};
  if (name == "actuator_dead_zone") return std::vector<double>{0.3 * swing * u};
  if (name == "sensor_offset") return std::vector<double>{0.3 * swing * u * sign};
  if (name == "sensor_drift") return std::vector<double>{0.6 * swing / duration_s * u * sign};
  return std::nullopt;
}

/// Parameters at full strength: what an engineer would call a fault worth finding, in the machine's own magnitudes.
std::vector<double> FullStrength(const Plan& plan, const Effect& effect, const Place& place, const Columns& healthy,
                                 Dice& dice) {
  const std::string& name = effect.info().name;
  const auto number = [&plan](const std::string& path, double otherwise) {
    const Value* value = plan.root.FindPath(path);
    return value != nullptr && value->is_number() ? value->number() : otherwise;
  };
  const double torque = number("plant.nominal_torque_Nm", 1000.0),
               k = number("plant.shaft." + place.name + ".stiffness_Nm_per_rad", 1e6);
  const double inertia = place.kind == "rotor" ? number("plant.rotor." + place.name + ".inertia_kg_m2", 10.0)
                                               : number("plant.inertia." + place.name, 1.0);
  const double speed = torque > 2000.0 ? 1.0 : 5.0, twist = 0.5 * torque / k;
  const double u = dice.Uniform(0.7, 1.4);
  const std::string plant = plan.root.FindPath("plant.type")->string();
  if (plant != "drive_line") {
    double swing = 0.0, peak = 0.0;
    const auto& signals = place.kind == "output" ? healthy.outputs : healthy.inputs;
    if (const auto signal = signals.find(place.name); signal != signals.end()) {
      swing = score::StandardDeviation(signal->second);
      for (const double v : signal->second) peak = std::max(peak, std::abs(v));
    }
    const auto found = PressureStrength(name, plant == "charge_air", u, dice.Sign(), swing, peak, healthy.time.back());
    if (found) return *found;
  }
  if (name == "viscous_friction") return {0.05 * torque / speed * u};
  if (name == "coulomb_friction") return {0.06 * torque * u};
  if (name == "stribeck_friction") return {0.05 * torque * u, 0.12 * torque * u, 0.2 * speed};
  if (name == "asymmetric_friction")
    return {0.07 * torque * u, 0.03 * torque * u, 0.02 * torque / speed, 0.005 * torque / speed};
  // Orders and pre-sliding angles of any value: drawn from a search's own starts they would be found too easily.
  if (name == "dahl_friction") return {0.06 * torque * u, 0.06 * torque * u / dice.Uniform(0.003, 0.03)};
  if (name == "constant_load") return {0.05 * torque * u * dice.Sign()};
  if (name == "quadratic_drag") return {0.03 * torque / speed / speed * u};
  if (name == "torque_ripple")
    return {0.05 * torque * u, std::exp(dice.Uniform(std::log(0.7), std::log(26.0))), dice.Uniform(-3, 3)};
  if (name == "inertia_change") return {0.25 * u * (dice.Uniform(0, 1) < 0.3 ? -1.0 : 1.0)};
  if (name == "stiffness_change") return {0.2 * u * dice.Sign()};
  if (name == "damping_change") return {2.0 * u};
  if (name == "distributed_inertia") return {33.0 * dice.Uniform(0.8, 1.0), 14e6 * u, 80.0 * u};
  if (name == "series_elasticity") return {5e6 * u * std::sqrt(inertia), 50.0 * u};
  if (name == "cubic_stiffness") return {0.3 * k / (twist * twist) * u};
  if (name == "backlash") return {0.3 * twist * u};
  if (name == "gap_change") return {0.2 * u};
  if (name == "contact_free_damping") return {0.1 * u};
  if (name == "oil_dynamics") return {78.3e3 * u, 232.0 * u, 1.54e5 * u};
  if (name == "viscosity_drift") return {std::min(0.9, 0.5 * u), 1.0 * u};
  if (name == "actuator_lag") return {1e-3 * u};
  if (name == "actuator_delay") return {3e-4 * u};
  if (name == "actuator_gain" || name == "sensor_gain") return {1.0 + 0.08 * u * dice.Sign()};
  if (name == "actuator_saturation") return {0.7 * 0.7 * torque * u};
  if (name == "actuator_dead_zone") return {0.15 * torque * u};
  if (name == "actuator_harmonic") return {0.08 * u * dice.Sign(), 0.05 * u};
  if (name == "sensor_offset") return {0.1 * number("output." + place.name + ".nominal", 1.0) * u * dice.Sign()};
  if (name == "sensor_delay") return {3e-4 * u};
  if (name == "sensor_lag") return {5e-4 * u};
  if (name == "sensor_drift") return {0.05 * number("output." + place.name + ".nominal", 1.0) * u};
  std::vector<double> start;
  for (const EffectParameter& p : effect.info().parameters) start.push_back(p.start);
  return start;
}

/// The same with every strength at a share of its distance from neutral.
std::vector<double> Weaker(const Effect& effect, std::vector<double> parameters, double share) {
  for (std::size_t i = 0; i < parameters.size(); ++i) {
    const double neutral = effect.info().parameters[i].neutral;
    if (std::isfinite(neutral) && neutral < effect.info().parameters[i].upper)
      parameters[i] = neutral + share * (parameters[i] - neutral);
  }
  return parameters;
}

/// What a relative change is by the scenario's own value, which the machine did not quite have before either: that is
/// what a diagnosis can find.
void AgainstNominal(Cause& cause, const Place& place, const Plan& nominal, const Plan& changed) {
  static const std::map<std::string, std::string> kKeys = {{"inertia_change", "inertia_kg_m2"},
                                                           {"stiffness_change", "stiffness_Nm_per_rad"},
                                                           {"damping_change", "damping_Nms_per_rad"}};
  const auto key = kKeys.find(cause.effect);
  if (key == kKeys.end()) return;
  const std::string of = fmt::format("plant.{}.{}", place.kind, place.name);
  const std::string path = place.kind == "inertia" ? of : of + "." + key->second;
  cause.parameters = {changed.root.FindPath(path)->number() / nominal.root.FindPath(path)->number() - 1.0};
}

/// Runs a plan with `reference`: another method, step and tolerance than what diagnoses.
Columns Simulated(const Plan& plan, const Registry& registry) {
  Diagnostics diagnostics;
  PrepareOptions options;
  options.solver = "reference";
  Plan bare = plan;
  bare.root.Erase("check");
  const std::unique_ptr<Prepared> prepared = Prepare(bare, options, registry, diagnostics);
  if (prepared == nullptr) throw std::runtime_error(diagnostics.Format());
  const auto solver = MakeSolver("reference", *prepared->rig);
  if (!solver.ok()) throw std::runtime_error(solver.failure().ToString());
  const Result<Samples> samples = Simulate(*prepared->rig, **solver);
  if (!samples.ok()) throw std::runtime_error(samples.failure().ToString());
  Columns columns{samples->time, {}, {}};
  for (std::size_t i = 0; i < prepared->rig->inputs.size(); ++i)
    columns.inputs[prepared->rig->inputs[i].name] = samples->inputs[i];
  for (std::size_t i = 0; i < prepared->rig->outputs.size(); ++i) {
    const std::string& name = prepared->rig->outputs[i].name;
    if (name != "phi_1") columns.outputs[name] = samples->outputs[i];
  }
  return columns;
}

/// Another excitation than the scenario's own.
void Excite(Plan& plan, Dice& dice, double duration_s) {
  if (plan.root["plant"]["type"].string() == "drive_line") plan.root["run"]["duration_s"] = Value(duration_s);
  // An undamped mode adds up the errors of all steps: a scenario that asks for more gets it.
  Value& tolerance = plan.root["run"]["reference"]["relative_tolerance"];
  tolerance = Value(std::min(1e-7, tolerance.is_number() ? tolerance.number() : 1.0));
  for (Value::Entry& input : plan.root["input"].table()) {
    Value* sources = input.value["source"].Find("sources");
    Value::Array single{input.value["source"]};
    Value::Array& list = sources != nullptr && sources->is_array() ? sources->array() : single;
    for (Value& source : list) {
      if (source.Find("seed") != nullptr) source["seed"] = Value(static_cast<std::int64_t>(dice.Uniform(1, 1e6)));
      if (source.Find("rms") != nullptr) source["rms"] = Value(source["rms"].number() * dice.Uniform(0.7, 1.3));
    }
    if (sources == nullptr) input.value["source"] = single.front();
  }
}

/// Nominal values slightly off, as data sheets are.
void Detune(Plan& plan, Dice& dice, double spread) {
  const auto each = [&](const std::string& path, double size) {
    Value* value = plan.root.FindPath(path);
    if (value != nullptr && value->is_number())
      *value = Value(value->number() * (1.0 + size * dice.Uniform(-1.0, 1.0)));
  };
  for (const char* key : {"mass_kg", "stiffness_N_per_m", "damping_Ns_per_m", "preload_N"})
    each(std::string("plant.") + key, spread);
  for (const char* section : {"inertia", "rotor", "shaft", "volume"}) {
    const Value* table = plan.root.FindPath(std::string("plant.") + section);
    for (const std::string& name : table != nullptr ? KeysOf(*table) : std::vector<std::string>{}) {
      const std::string path = fmt::format("plant.{}.{}", section, name);
      each(path, spread);
      each(path + ".volume_m3", spread);
      each(path + ".inertia_kg_m2", spread);
      each(path + ".stiffness_Nm_per_rad", spread);
      each(path + ".damping_Nms_per_rad", 10.0 * spread);
    }
  }
}

/// What an effect of `plan` is drawn from.
std::vector<const Effect*> PossibleIn(const Plan& plan, const Registry& registry,
                                      const std::vector<std::string>& only) {
  std::vector<const Effect*> possible;
  for (const Effect* effect : registry.Effects()) {
    if (!effect->Places(plan).empty() &&
        (only.empty() || std::find(only.begin(), only.end(), effect->info().name) != only.end()))
      possible.push_back(effect);
  }
  return possible;
}

/// Draws an effect, its place and its size, and puts it into `plan`; `without`: the record so far.
void HideIn(Plan& plan, const Plan& nominal, const Columns& without, const Registry& registry,
            const std::vector<std::string>& only, Case& hidden, Dice& dice) {
  const std::vector<const Effect*> possible = PossibleIn(plan, registry, only);
  const Effect* effect = possible.at(dice.Index(possible.size()));
  std::vector<Place> places = effect->Places(plan);
  std::erase_if(places, [](const Place& place) { return place.name == "phi_1"; });
  const Place place = places.at(dice.Index(places.size()));
  const std::vector<double> full = FullStrength(plan, *effect, place, without, dice);
  hidden.strength = std::vector<double>{0.3, 1.0, 1.0}[dice.Index(3)];
  Cause cause{effect->info().name, place.ToString(), Weaker(*effect, full, hidden.strength)};
  effect->Apply(plan, place, cause.parameters);
  AgainstNominal(cause, place, nominal, plan);
  hidden.causes.push_back(std::move(cause));
}

}  // namespace

std::optional<Columns> FromReference(Case& hidden, Dice& dice, double duration_s, const Registry& registry,
                                     const std::vector<std::string>& only) {
  Diagnostics diagnostics;
  const auto files = FindScenarios(hidden.scenario, diagnostics);
  std::optional<Plan> plan = LoadPlan(files.at(0), {}, diagnostics);
  if (!plan) throw std::runtime_error(diagnostics.Format());
  Excite(*plan, dice, duration_s);
  const Plan nominal = *plan;
  Detune(*plan, dice, hidden.kind == "null" && hidden.inexact.empty() ? 0.0 : 0.003);
  if (hidden.kind == "decoy" && dice.Uniform(0, 1) < 0.4 && plan->root["plant"]["type"].string() == "drive_line")
    plan->root["plant"]["initial_speed_rad_per_s"] = Value(dice.Uniform(-3.0, 3.0));
  Columns columns = Simulated(*plan, registry);
  const bool creeps = hidden.IsInexactBy("creeping");
  if (MakeInexact(*plan, columns, hidden, dice)) {
    Columns changed = Simulated(*plan, registry);
    hidden.inexact_size = SizeOf(changed, columns, hidden.noise);
    columns = std::move(changed);
  }
  hidden.size = std::numeric_limits<double>::infinity();
  for (int left = hidden.kind == "effect" ? 1 : hidden.kind == "pair" ? 2 : 0; left > 0; --left) {
    HideIn(*plan, nominal, columns, registry, creeps ? std::vector<std::string>{"coulomb_friction"} : only, hidden,
           dice);
    if (hidden.causes.size() > 1 && hidden.causes[0].at == hidden.causes[1].at) return std::nullopt;
    Columns changed = Simulated(*plan, registry);
    hidden.size = std::min(hidden.size, SizeOf(changed, columns, hidden.noise));
    if (hidden.size < kSmallestSize) return std::nullopt;
    if (creeps) {
      LetCreep(*plan, hidden, dice);
      Columns creeping = Simulated(*plan, registry);
      hidden.inexact_size = std::max(hidden.inexact_size, SizeOf(creeping, changed, hidden.noise));
      changed = std::move(creeping);
    }
    columns = std::move(changed);
  }
  if (hidden.causes.empty()) hidden.size = 0.0;
  return columns;
}

}  // namespace dynoproof::blind
