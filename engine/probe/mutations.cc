#include "probe/mutations.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "model/effect_size.h"
#include "model/motion.h"
#include "score/series.h"

namespace dynoproof::probe {
namespace {

/// The size at which the first of the sized parameters reaches its bound in this direction.
double LargestSize(const EffectInfo& info, const std::vector<std::size_t>& sized, const std::vector<double>& start,
                   int sign) {
  double largest = std::numeric_limits<double>::infinity();
  for (const std::size_t i : sized) {
    const EffectParameter& parameter = info.parameters[i];
    const double from = std::isfinite(parameter.neutral) ? parameter.neutral : 0.0;
    const double step = sign * (start[i] - from);
    if (step == 0.0) continue;
    largest = std::min(largest, ((step > 0.0 ? parameter.upper : parameter.lower) - from) / step);
  }
  return std::isfinite(largest) ? largest : 0.0;
}

/// Gives the parameters of an effect, in its order, for a size.
using ValuesAt = std::function<std::vector<double>(double size)>;

/// Takes an effect up with these values.
void Add(const Effect& effect, const Place& place, Mutation mutation, const ValuesAt& values,
         std::vector<Mutation>& all) {
  mutation.name = effect.info().name;
  mutation.place = place.ToString();
  mutation.apply = [&effect, place, values](Plan& plan, double size) { effect.Apply(plan, place, values(size)); };
  mutation.parameters = [&effect, values](double size) {
    EffectValues named;
    const std::vector<double> at = values(size);
    for (std::size_t i = 0; i < at.size(); ++i) named.emplace_back(effect.info().parameters[i].name, at[i]);
    return named;
  };
  all.push_back(std::move(mutation));
}

/// An effect that grows from a neutral value, once for each direction that its bounds leave.
void AddGrowing(const Effect& effect, const Place& place, const Plan& plan, const std::vector<double>& start,
                std::vector<Mutation>& all) {
  const EffectInfo& info = effect.info();
  const std::vector<std::size_t> sized = SizedWith(info);
  const std::size_t first = StrengthsOf(info).front();
  const double step = start[first] - info.parameters[first].neutral;
  if (step == 0.0) return;
  for (const int sign : {1, -1}) {
    // Upwards first, whichever way the search of the effect begins.
    const int along = step > 0.0 ? sign : -sign;
    const double largest = LargestSize(info, sized, start, along);
    if (!(largest > 0.0)) continue;
    const ValuesAt values = [&effect, start, sized, along](double size) {
      std::vector<double> at = start;
      for (const std::size_t i : sized) {
        const EffectParameter& parameter = effect.info().parameters[i];
        const double from = std::isfinite(parameter.neutral) ? parameter.neutral : 0.0;
        at[i] = std::clamp(from + along * size * (start[i] - from), parameter.lower, parameter.upper);
      }
      return at;
    };
    Add(effect, place,
        {.unit = effect.UnitAt(first, place, plan), .sign = sign, .usual = std::abs(step), .largest = largest}, values,
        all);
  }
}

/// A parameter that vanishes at its upper bound, as a limit, and bites the more the smaller it is; nothing: there is none.
std::optional<std::size_t> LimitOf(const EffectInfo& info) {
  for (std::size_t i = 0; i < info.parameters.size(); ++i) {
    const EffectParameter& parameter = info.parameters[i];
    if (parameter.neutral == parameter.upper && parameter.lower > 0.0) return i;
  }
  return std::nullopt;
}

void AddFalling(const Effect& effect, const Place& place, const Plan& plan, const std::vector<double>& start,
                std::size_t limit, std::vector<Mutation>& all) {
  const EffectParameter& parameter = effect.info().parameters[limit];
  const double from = parameter.neutral, to = start[limit];
  if (!(to > 0.0) || !(to < from)) return;
  const ValuesAt values = [start, limit, from, to](double size) {
    std::vector<double> at = start;
    at[limit] = from * std::pow(to / from, size);
    return at;
  };
  Add(effect, place,
      {.unit = effect.UnitAt(limit, place, plan),
       .usual = to,
       .largest = std::log(parameter.lower / from) / std::log(to / from),
       .falling = true,
       .neutral = from,
       .start = to},
      values, all);
}

void AddEffect(const Effect& effect, const Place& place, const Plan& plan, const Magnitudes& magnitudes,
               std::vector<Mutation>& all) {
  const EffectInfo& info = effect.info();
  std::vector<double> start = effect.Starts(plan, place, magnitudes).front();
  for (std::size_t i = 0; i < start.size(); ++i)
    start[i] = std::clamp(start[i], info.parameters[i].lower, info.parameters[i].upper);
  if (!StrengthsOf(info).empty()) return AddGrowing(effect, place, plan, start, all);
  if (const auto limit = LimitOf(info)) return AddFalling(effect, place, plan, start, *limit, all);
  Add(
      effect, place, {}, [start](double) { return start; }, all);
}

/// The paths of all numbers below `value` that are not 0.
void NumbersIn(const Value& value, const std::string& path, std::vector<std::string>& paths) {
  if (value.is_number() && value.number() != 0.0) paths.push_back(path);
  if (value.is_table()) {
    for (const Value::Entry& entry : value.table()) NumbersIn(entry.value, path + "." + entry.key, paths);
  }
  if (value.is_array()) {
    for (std::size_t i = 0; i < value.array().size(); ++i)
      NumbersIn(value.array()[i], fmt::format("{}.{}", path, i), paths);
  }
}

void Scale(Plan& plan, const std::string& path, double by) {
  Value& value = *plan.root.FindPath(path);
  Value scaled(value.number() * by);
  scaled.set_where(value.where());
  value = std::move(scaled);
}

/// A signal's sign turned by a last stage of its chain.
void TurnSignal(Plan& plan, const char* section, const std::string& name) {
  Value& chain = plan.root[section][name][std::string_view(section) == "input" ? "actuator" : "sensor"];
  Value::Array stages;
  if (chain.is_array()) stages = chain.array();
  if (chain.is_table() && chain.Find("type") != nullptr) stages.push_back(chain);
  stages.push_back(Value{{"type", "gain"}, {"gain", -1.0}});
  chain = Value(std::move(stages));
}

}  // namespace

double Mutation::StrengthAt(double size) const {
  return falling ? neutral * std::pow(start / neutral, size) : sign * size * usual;
}

std::string Mutation::Key() const {
  return fmt::format("{}@{}{}", name, place, !sized() || falling ? "" : sign > 0 ? " +" : " -");
}

Magnitudes MagnitudesOf(const Rig& rig, const Samples& samples) {
  Magnitudes m;
  m.duration_s = std::max(samples.time.back(), 1e-3);
  m.step_s = rig.SecondsOf(rig.period);
  for (std::size_t i = 0; i < rig.inputs.size(); ++i) {
    const std::string& name = rig.inputs[i].name;
    m.input_rms[name] = score::RootMeanSquare(samples.inputs[i]);
    m.input_peak[name] = score::Largest(samples.inputs[i]);
    m.input = std::max(m.input, m.input_rms[name]);
  }
  double torque = 0.0, speed = 0.0;
  for (std::size_t i = 0; i < rig.outputs.size(); ++i) {
    const OutputLine& line = rig.outputs[i];
    const std::vector<double>& values = samples.outputs[i];
    double mean = 0.0;
    for (const double value : values) mean += value / static_cast<double>(values.size());
    const double rms = score::RootMeanSquare(values);
    m.output_spread[line.name] = std::sqrt(std::max(0.0, rms * rms - mean * mean));
    if (IsForce(line.unit)) torque = std::max(torque, rms);
    if (IsSpeed(line.unit)) speed = std::max(speed, rms);
  }
  m.torque = torque > 0.0 ? torque : m.input > 0.0 ? m.input : 1.0;
  m.speed = speed > 0.0 ? speed : 1.0;
  return m;
}

std::vector<Mutation> MutationsOf(const Plan& plan, const Registry& registry, const Magnitudes& magnitudes) {
  std::vector<Mutation> all;
  for (const Effect* effect : registry.Effects()) {
    for (const Place& place : effect->Places(plan)) AddEffect(*effect, place, plan, magnitudes, all);
  }
  for (const char* section : {"input", "output"}) {
    const Value* signals = plan.root.Find(section);
    if (signals == nullptr || !signals->is_table()) continue;
    for (const Value::Entry& entry : signals->table()) {
      all.push_back(
          {.name = kTurnedSign,
           .place = fmt::format("{}:{}", section, entry.key),
           .apply = [section, name = entry.key](Plan& changed, double) { TurnSignal(changed, section, name); }});
    }
  }
  for (const char* section : {"plant", "control"}) {
    const Value* values = plan.root.Find(section);
    std::vector<std::string> paths;
    if (values != nullptr) NumbersIn(*values, section, paths);
    for (const std::string& path : paths) {
      all.push_back(
          {.name = kDroppedTerm, .place = path, .apply = [path](Plan& changed, double) { Scale(changed, path, 0.0); }});
      all.push_back(
          {.name = kTurnedSign, .place = path, .apply = [path](Plan& changed, double) { Scale(changed, path, -1.0); }});
    }
  }
  std::ranges::stable_sort(all, [](const Mutation& a, const Mutation& b) {
    return std::pair(a.name, a.place) < std::pair(b.name, b.place);
  });
  return all;
}

}  // namespace dynoproof::probe
