#include "diagnosis/candidates.h"

#include <algorithm>
#include <cmath>
#include <functional>

#include "score/series.h"

namespace dynoproof::diagnosis {
namespace {

using Starts = std::vector<std::vector<double>>;

double NumberAt(const Plan& plan, const std::string& path, double otherwise) {
  const Value* value = plan.root.FindPath(path);
  return value != nullptr && value->is_number() ? value->number() : otherwise;
}

double StiffestShaft(const Plan& plan) {
  double stiffest = 0.0;
  const Value* shafts = plan.root.FindPath("plant.shaft");
  for (const std::string& name : shafts != nullptr ? KeysOf(*shafts) : std::vector<std::string>{})
    stiffest = std::max(stiffest, NumberAt(plan, "plant.shaft." + name + ".stiffness_Nm_per_rad", 0.0));
  return stiffest > 0.0 ? stiffest : 1e6;
}

/// Total inertia, and the share of a run.
double InertiaOf(const Plan& plan, const std::vector<std::string>& names) {
  double sum = 0.0;
  for (const std::string& name : names) sum += NumberAt(plan, "plant.inertia." + name, 0.0);
  return sum;
}

/// A rotor instead of a run: its inertia, and the springs of the run in series, as the thesis' first guess (2.94).
Starts RotorStarts(const Plan& plan, const std::string& run) {
  std::vector<std::string> inertias;
  const Value* list = plan.root.FindPath("plant.run." + run + ".inertias");
  if (list != nullptr && list->is_array()) {
    for (const Value& item : list->array()) {
      if (item.is_string()) inertias.push_back(item.string());
    }
  }
  const double inertia = InertiaOf(plan, inertias);
  double compliance = 0.0;
  const Value* shafts = plan.root.FindPath("plant.shaft");
  for (const std::string& name : shafts != nullptr ? KeysOf(*shafts) : std::vector<std::string>{}) {
    const Value* between = shafts->Find(name)->Find("between");
    int inside = 0;
    for (const Value& end : between != nullptr && between->is_array() ? between->array() : Value::Array{})
      inside += end.is_string() && std::find(inertias.begin(), inertias.end(), end.string()) != inertias.end() ? 1 : 0;
    const double k = NumberAt(plan, "plant.shaft." + name + ".stiffness_Nm_per_rad", 0.0);
    if (inside == 2 && k > 0.0) compliance += 1.0 / k;
  }
  const double k = compliance > 0.0 ? 1.0 / compliance : 1e7;
  Starts starts;
  for (const double share : {0.75, 1.0}) {
    for (const double factor : {0.8, 1.0, 1.3}) starts.push_back({share * inertia, factor * k, 5e-6 * k});
  }
  return starts;
}

/// Starts by the effect's name; effects that are not named here start where they say themselves.
Starts StartsOf(const Study& study, const Magnitudes& m, const Effect& effect, const Place& place) {
  const std::string& name = effect.info().name;
  const Plan& plan = study.plan();
  const double friction = 0.02 * m.torque, step_s = study.channels().front().step_s;
  const auto size = [&place](const std::map<std::string, double>& sizes) {
    const auto found = sizes.find(place.name);
    return found != sizes.end() && found->second > 0.0 ? found->second : 1.0;
  };
  const double k = NumberAt(plan, "plant.shaft." + place.name + ".stiffness_Nm_per_rad", 0.0);
  const double twist = k > 0.0 ? m.torque / k : 1e-3;
  if (name == "viscous_friction") return {{friction / m.speed}};
  if (name == "coulomb_friction") return {{friction}};
  if (name == "stribeck_friction")
    return {{friction, 2 * friction, 0.1 * m.speed}, {friction, 2 * friction, 0.5 * m.speed}};
  if (name == "asymmetric_friction") return {{friction, friction, friction / m.speed, friction / m.speed}};
  if (name == "dahl_friction") {
    Starts starts;
    for (const double angle : {1e-4, 1e-3, 1e-2, 0.1}) starts.push_back({friction, friction / angle});
    return starts;
  }
  if (name == "constant_load") return {{friction}};
  if (name == "quadratic_drag") return {{friction / (m.speed * m.speed)}};
  if (name == "torque_ripple") {
    Starts starts;
    // Orders of poles, slots and gears; an order between them is reached by the search where the angle stays small.
    for (const double n : {1., 2., 3., 4., 5., 6., 8., 10., 12., 16., 18., 20., 24., 30., 36., 48., 60., 72.})
      starts.push_back({friction, n, 0.0});
    return starts;
  }
  if (name == "distributed_inertia") return RotorStarts(plan, place.name);
  if (name == "series_elasticity") {
    const double stiffest = StiffestShaft(plan), inertia = NumberAt(plan, "plant.inertia." + place.name, 1.0);
    Starts starts;
    for (const double factor : {0.1, 0.3, 1.0, 3.0, 10.0}) {
      const double joint = factor * stiffest;
      starts.push_back({joint, 0.01 * std::sqrt(joint * inertia)});
    }
    return starts;
  }
  // In a resonance, or where no torque was measured, the twist is several times that of the torque at rest.
  if (name == "cubic_stiffness") return {{0.02 * k / (twist * twist)}, {0.001 * k / (twist * twist)}};
  if (name == "backlash") return {{0.03 * twist}, {0.3 * twist}};
  // Starts far off too: a resonance that moved by more than its width leaves no slope to follow.
  if (name == "inertia_change" || name == "stiffness_change")
    return {{0.02}, {-0.5}, {-0.3}, {-0.2}, {-0.1}, {0.1}, {0.2}, {0.35}, {0.6}, {1.0}};
  if (name == "damping_change") return {{0.2}, {2.0}};
  if (name == "oil_dynamics") {
    const double c = NumberAt(plan, "plant.shaft." + place.name + ".damping_Nms_per_rad", 500.0);
    Starts starts;
    for (const double kappa : {60.0, 200.0, 600.0}) starts.push_back({0.9 * k, kappa, c * kappa});
    return starts;
  }
  if (name == "viscosity_drift") {
    return {{0.2, 0.05 * m.duration_s}, {0.2, 0.2 * m.duration_s}, {0.2, 0.7 * m.duration_s}};
  }
  // The screening adds how late a signal comes: a delay beyond the signal's own width has no slope back to one sample.
  if (IsDelay(effect)) return {{step_s}};
  if (IsLag(effect)) return {{step_s}, {4.0 * step_s}, {16.0 * step_s}, {64.0 * step_s}};
  if (name == "actuator_saturation") {
    Starts starts;
    for (const double share : {0.5, 0.7, 0.85, 0.95}) starts.push_back({share * size(m.input_peak)});
    return starts;
  }
  // A wide one lets only peaks through: from a narrow one no slope leads there.
  if (name == "actuator_dead_zone") {
    Starts starts;
    for (const double share : {0.05, 0.5, 1.5, 5.0}) starts.push_back({share * size(m.input_rms)});
    return starts;
  }
  if (name == "sensor_offset") return {{0.05 * size(m.output_spread)}};
  if (name == "sensor_drift") return {{0.05 * size(m.output_spread) / m.duration_s}};
  // Play and stiction that the record does not exceed hide all motion: several sizes, the smallest first.
  if (name == "actuator_hysteresis") return {{0.01 * size(m.input_peak)}, {0.05 * size(m.input_peak)}};
  if (name == "flow_area_error") return {{1.02}, {0.98}, {0.9}, {1.1}, {0.75}, {1.3}};
  if (name == "valve_stiction") return {{2.0}, {10.0}, {40.0}};
  std::vector<double> start;
  for (const EffectParameter& p : effect.info().parameters) start.push_back(p.start);
  return {start};
}

/// Parameters that scale an effect about linearly from its neutral value, where that value is finite and within reach.
std::vector<std::size_t> StrengthsOf(const Effect& effect) {
  std::vector<std::size_t> strengths;
  const std::vector<EffectParameter>& parameters = effect.info().parameters;
  for (std::size_t i = 0; i < parameters.size(); ++i) {
    if (std::isfinite(parameters[i].neutral) && parameters[i].neutral < parameters[i].upper) strengths.push_back(i);
  }
  return strengths;
}

}  // namespace

Magnitudes MagnitudesOf(const Study& study) {
  Magnitudes m;
  const MappedRecord& record = study.records().front();
  m.duration_s = std::max(record.end_s, 1e-3);
  for (const auto& [name, series] : record.inputs) {
    m.input_rms[name] = score::RootMeanSquare(*series.values);
    m.input_peak[name] = score::Largest(*series.values);
    m.input = std::max(m.input, m.input_rms[name]);
  }
  double torque = 0.0, speed = 0.0;
  for (const Channel& channel : study.channels()) {
    if (channel.record != 0) continue;
    m.output_spread[channel.name] = channel.spread;
    const double rms = score::RootMeanSquare(*record.outputs.at(channel.name).values);
    if (channel.unit == "N m" || channel.unit == "N") torque = std::max(torque, rms);
    if (channel.unit == "rad/s") speed = std::max(speed, rms);
  }
  m.torque = torque > 0.0 ? torque : m.input > 0.0 ? m.input : 1.0;
  m.speed = speed > 0.0 ? speed : 1.0;
  return m;
}

std::vector<Candidate> CandidatesFor(const Study& study, const Magnitudes& magnitudes) {
  std::vector<Candidate> candidates;
  const Value* type = study.plan().root.FindPath("plant.type");
  const bool moved = type != nullptr && type->is_string() && type->string() == "moved_body";
  for (const Effect* effect : study.registry().Effects()) {
    const std::string& name = effect->info().name;
    const std::vector<Place> places = effect->Places(study.plan());
    for (const Place& place : places) {
      // A sensor that no record has, and an input that no record drives, cannot be seen.
      if (place.kind == "output" && std::none_of(study.channels().begin(), study.channels().end(),
                                                 [&](const Channel& c) { return c.name == place.name; }))
        continue;
      if (place.kind == "input" && !study.records().front().inputs.contains(place.name)) continue;
      Candidate candidate{effect, place, StartsOf(study, magnitudes, *effect, place), StrengthsOf(*effect), false};
      // Where the motion is given a run costs next to nothing, and elastic friction need not look like a dry one.
      const bool other_friction = IsDryFriction(*effect) && name != "coulomb_friction";
      // Any order of ripple is tried at both ends of the line, of which one may be heavy; the rest follow them.
      const bool between = place != places.front() && place != places.back();
      candidate.refinement = (other_friction && !moved) || (name == "torque_ripple" && between);
      for (std::vector<double>& start : candidate.starts) {
        for (std::size_t i = 0; i < start.size(); ++i)
          start[i] = std::clamp(start[i], effect->info().parameters[i].lower, effect->info().parameters[i].upper);
      }
      candidates.push_back(std::move(candidate));
    }
  }
  return candidates;
}

bool IsDelay(const Effect& effect) {
  return effect.info().name == "actuator_delay" || effect.info().name == "sensor_delay";
}

bool IsLag(const Effect& effect) { return effect.info().name == "actuator_lag" || effect.info().name == "sensor_lag"; }

bool IsDryFriction(const Effect& effect) {
  const std::string& name = effect.info().name;
  return name == "coulomb_friction" || name == "dahl_friction" || FallsOrDiffers(effect);
}

bool FallsOrDiffers(const Effect& friction) {
  return friction.info().name == "stribeck_friction" || friction.info().name == "asymmetric_friction";
}

}  // namespace dynoproof::diagnosis
