#include "diagnosis/trial.h"

#include <algorithm>

#include "diagnosis/candidates.h"

namespace dynoproof::diagnosis {
namespace {

using Eigen::Index;
using Eigen::VectorXd;
using estimation::DataSet;
using estimation::Hypothesis;

/// The parameters that grow with the size of an effect: its strengths, and what is one of them by something, as the stiffness
/// of a friction that is elastic: the stretch at which it gives way stays.
std::vector<std::size_t> SizedWith(const Effect& effect) {
  std::vector<std::size_t> sized = StrengthsOf(effect);
  const std::vector<EffectParameter>& all = effect.info().parameters;
  const std::vector<std::size_t> strengths = sized;
  for (std::size_t i = 0; i < all.size(); ++i) {
    const bool by = std::ranges::any_of(
        strengths, [&](std::size_t k) { return k != i && all[i].unit.starts_with(all[k].unit + "/"); });
    if (by && std::ranges::find(sized, i) == sized.end()) sized.push_back(i);
  }
  return sized;
}

}  // namespace

std::vector<Trial> TrialsOf(const estimation::Hypothesis& base, const Levels& levels, const Magnitudes& magnitudes,
                            const Registry& registry) {
  std::vector<Trial> candidates;
  const DataSet& data = levels.data();
  for (const Effect* effect : registry.Effects()) {
    for (const Place& place : effect->Places(base.nominal())) {
      if (!CanBeSeen(place, data.channels(), data.records().front())) continue;
      if (std::ranges::find(base.effects(), Hypothesis::Applied{effect, place}) != base.effects().end()) continue;
      Trial candidate{effect, place, base.With(*effect, place, magnitudes), {}, SizedWith(*effect)};
      const std::size_t first = base.of_effects(), count = effect->info().parameters.size();
      const auto& parameters = candidate.hypothesis.parameters();
      for (const std::vector<double>& start : effect->Starts(base.nominal(), place, magnitudes)) {
        VectorXd q(static_cast<Index>(count));
        for (std::size_t i = 0; i < count; ++i) {
          const estimation::Parameter& own = parameters[first + i];
          q[static_cast<Index>(i)] = own.CoordinateOf(std::clamp(start[i], own.lower, own.upper));
        }
        candidate.starts.push_back(std::move(q));
      }
      candidates.push_back(std::move(candidate));
    }
  }
  return candidates;
}

}  // namespace dynoproof::diagnosis
