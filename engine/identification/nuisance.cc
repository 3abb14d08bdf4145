#include "identification/nuisance.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <tuple>
#include <utility>

#include "model/prior.h"

namespace dynoproof::identification {

std::vector<Nuisance> NuisancesOf(const Plan& plan, const Registry& registry, bool released) {
  const PlantTraits& plant = registry.PlantOf(plan);
  constexpr double kWidest = 0.5;  // a spread for a number without a prior, where one is needed
  std::map<std::string, std::pair<const Effect*, Place>> scaled;  // by the path of the number
  for (const Effect* effect : registry.Effects()) {
    for (const Place& place : effect->Places(plan)) scaled.try_emplace(effect->ScaledIn(plan, place), effect, place);
  }
  std::vector<Nuisance> nuisances;
  for (const NuisanceParameter& one : NuisancesWithPriors(plant, plan)) {
    const Value* value = plan.root.FindPath(one.path);
    if (one.only_released && !released) continue;
    if (one.relative && (value == nullptr || !value->is_number() || value->number() == 0.0)) continue;
    nuisances.push_back({one.path,
                         one.relative,
                         std::min(one.spread, one.relative ? kWidest : kNoPrior),
                         one.initial,
                         nullptr,
                         {},
                         one.only_in_motion});
    const auto found = one.relative ? scaled.find(one.path) : scaled.end();
    if (found != scaled.end()) std::tie(nuisances.back().effect, nuisances.back().at) = found->second;
  }
  return nuisances;
}

NuisanceValue ValueOf(const Nuisance& nuisance, double z, const Plan& plan) {
  const Value* found = plan.root.FindPath(nuisance.path);
  const double nominal = found != nullptr && found->is_number() ? found->number() : 0.0;
  if (nuisance.relative) return {nominal, nominal * std::exp(std::clamp(nuisance.spread * z, -7.0, 7.0))};
  const double value = nominal + nuisance.spread * z;
  return {nominal, value};
}

void ApplyNuisances(const std::vector<Nuisance>& nuisances, const std::vector<double>& z, Plan& plan) {
  for (std::size_t i = 0; i < nuisances.size(); ++i) {
    if (z[i] == 0.0) continue;
    const std::size_t dot = nuisances[i].path.rfind('.');
    Value* parent = plan.root.FindPath(nuisances[i].path.substr(0, dot));
    if (parent == nullptr || !parent->is_table()) continue;
    const std::string key = nuisances[i].path.substr(dot + 1);
    if (nuisances[i].relative && parent->Find(key) == nullptr) continue;
    (*parent)[key] = Value(ValueOf(nuisances[i], z[i], plan).value);
  }
}

}  // namespace dynoproof::identification
