#include "model/effect.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "model/registry.h"

namespace dynoproof {

std::string Place::ToString() const { return kind + ":" + name + (quantity.empty() ? "" : "@" + quantity); }

std::optional<Place> ParsePlace(std::string_view text) {
  const std::size_t colon = text.find(':');
  if (colon == std::string_view::npos || colon == 0 || colon + 1 == text.size()) return std::nullopt;
  Place place;
  place.kind = text.substr(0, colon);
  text.remove_prefix(colon + 1);
  const std::size_t at = std::min(text.find('@'), text.size());
  place.name = text.substr(0, at);
  if (at < text.size()) place.quantity = text.substr(at + 1);
  return place;
}

std::string Effect::ScaledIn(const Plan& plan, const Place& place) const {
  std::string path = ScaledParameter(place);
  const std::size_t dot = path.rfind('.');
  const Value* table = dot == std::string::npos ? nullptr : plan.root.FindPath(path.substr(0, dot));
  // The name of a body is no key that carries a unit: it is there as it is.
  if (table == nullptr || table->Find(path.substr(dot + 1)) != nullptr) return path;
  return path.substr(0, dot + 1) + KeyIn(MotionIn(plan.root), *table, path.substr(dot + 1));
}

std::string Effect::UnitAt(std::size_t index, const Place& place, const Plan& plan) const {
  const EffectParameter& parameter = info_.parameters[index];
  if (!parameter.of_signal) {
    const bool slides = PlantOf(plan).slides || MotionIn(plan.root) == Motion::kTranslation;
    // A harmonic's phase is an angle in either motion; its order, per turn of a body, counts radians per length.
    if (slides && info_.traits.harmonic && index > 0) return index == 1 ? "rad/m" : parameter.unit;
    return UnitIn(slides ? Motion::kTranslation : Motion::kRotation, parameter.unit);
  }
  const std::string unit = plan.root.TextOr(place.kind + "." + place.name + ".unit");
  if (unit.empty() || unit == "1") return parameter.unit;
  if (parameter.unit == "1") return unit;
  return unit.ends_with("/s") ? unit + "^2" : unit + "/s";  // a drift
}

const PlantTraits& PlantOf(const Plan& plan, const PlantCatalogue& plants) {
  static const PlantTraits none;
  const Value* type = plan.root.FindPath("plant.type");
  const auto found = type != nullptr && type->is_string() ? plants.find(type->string()) : plants.end();
  return found != plants.end() ? found->second : none;
}

const PlantTraits& Effect::PlantOf(const Plan& plan) const {
  static const PlantCatalogue none;
  return dynoproof::PlantOf(plan, plants_ != nullptr ? *plants_ : none);
}

Points Effect::Starts(const Plan&, const Place&, const Magnitudes&) const {
  std::vector<double> start;
  for (const EffectParameter& parameter : info_.parameters) start.push_back(parameter.start);
  return {start};
}

namespace {

/// The parameters in the effect's order; faults are reported.
bool ReadParameters(const Effect& effect, const EffectUse& use, const Plan& plan, std::vector<double>& values,
                    Diagnostics& diagnostics) {
  const EffectInfo& info = effect.info();
  const Place place = ParsePlace(use.at).value_or(Place{});
  const std::string more = "dynoproof describe " + info.name;
  std::vector<std::string> names;
  for (const EffectParameter& parameter : info.parameters) names.push_back(parameter.name);
  bool good = true;
  for (std::size_t i = 0; i < names.size(); ++i) {
    const EffectParameter& parameter = info.parameters[i];
    const std::string unit = effect.UnitAt(i, place, plan);
    const Value* value = use.parameters.Find(parameter.name);
    if (value == nullptr) {
      diagnostics.Error(
          use.where, fmt::format("effect {} needs the parameter \"{}\"", info.name, parameter.name),
          fmt::format("{} [{}], {} ... {}", parameter.description, unit, parameter.lower, parameter.upper), more);
      good = false;
    } else if (!value->is_number() || !Between(parameter.lower, parameter.upper).Contains(value->number())) {
      diagnostics.Error(value->where(), fmt::format("\"{}\" of effect {} is out of range", parameter.name, info.name),
                        fmt::format("a number [{}], {} ... {}", unit, parameter.lower, parameter.upper), more);
      good = false;
    } else {
      values.push_back(value->number());
    }
  }
  for (const Value::Entry& entry : use.parameters.is_table() ? use.parameters.table() : Value::Table{}) {
    if (std::find(names.begin(), names.end(), entry.key) != names.end()) continue;
    const std::optional<std::string> near = Closest(entry.key, names);
    diagnostics.Error(
        entry.where, fmt::format("effect {} has no parameter \"{}\"", info.name, entry.key),
        near ? fmt::format("did you mean \"{}\"?", *near) : fmt::format("it has: {}", fmt::join(names, ", ")), more);
    good = false;
  }
  return good;
}

}  // namespace

bool ApplyEffect(const Registry& registry, const EffectUse& use, Plan& plan, Diagnostics& diagnostics) {
  const Effect* effect = registry.FindEffect(use.name);
  if (effect == nullptr) {
    std::vector<std::string> names, described;  // the latter in these words: "dry_friction"
    std::string words = use.name;
    std::ranges::replace(words, '_', ' ');
    for (const Effect* known : registry.Effects()) {
      names.push_back(known->info().name);
      if (!words.empty() && known->info().description.find(words) != std::string::npos)
        described.push_back(names.back());
    }
    const std::optional<std::string> near = described.size() == 1 ? described.front() : Closest(use.name, names);
    diagnostics.Error(use.name_where.known() ? use.name_where : use.where,
                      fmt::format("there is no effect \"{}\"", use.name),
                      near ? fmt::format("did you mean \"{}\"?", *near) : "", "dynoproof list");
    return false;
  }
  std::vector<double> values;
  bool good = ReadParameters(*effect, use, plan, values, diagnostics);
  const std::vector<Place> places = effect->Places(plan);
  const std::optional<Place> place = ParsePlace(use.at);
  if (!place || std::find(places.begin(), places.end(), *place) == places.end()) {
    std::vector<std::string> known;
    for (const Place& one : places) known.push_back(one.ToString());
    const std::optional<std::string> near = Closest(use.at, known);
    diagnostics.Error(use.at_where.known() ? use.at_where : use.where,
                      fmt::format("effect {} cannot sit at \"{}\"", use.name, use.at),
                      near            ? fmt::format("did you mean \"{}\"?", *near)
                      : known.empty() ? "this scenario has no place for it"
                                      : fmt::format("places: {}", fmt::join(known, ", ")));
    good = false;
  }
  if (good) effect->Apply(plan, *place, values);
  return good;
}

bool ApplyEffects(const Registry& registry, Plan& plan, Diagnostics& diagnostics) {
  const int before = diagnostics.error_count();
  for (const EffectUse& use : ReadEffects(plan, diagnostics)) ApplyEffect(registry, use, plan, diagnostics);
  plan.root.Erase("effect");
  return diagnostics.error_count() == before;
}

}  // namespace dynoproof
