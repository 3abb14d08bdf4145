#include "diagnosis/doubt.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <tuple>
#include <utility>

namespace dynoproof::diagnosis {

std::vector<Doubt> DoubtsOf(const Plan& plan, const Registry& registry) {
  const PlantTraits& plant = registry.PlantOf(plan);
  if (!plant.nuisances) return {};
  std::map<std::string, std::pair<const Effect*, Place>> scaled;  // by the path of the number
  for (const Effect* effect : registry.Effects()) {
    for (const Place& place : effect->Places(plan)) scaled.try_emplace(effect->ScaledParameter(place), effect, place);
  }
  std::vector<Doubt> doubts;
  for (const NuisanceParameter& one : plant.nuisances(plan)) {
    const Value* value = plan.root.FindPath(one.path);
    if (one.relative && (value == nullptr || !value->is_number() || value->number() == 0.0)) continue;
    doubts.push_back({one.path, one.relative, one.spread, one.initial, nullptr, {}, one.only_with_structure});
    const auto found = one.relative ? scaled.find(one.path) : scaled.end();
    if (found != scaled.end()) std::tie(doubts.back().effect, doubts.back().at) = found->second;
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
