#include "diagnosis/carried_along.h"

#include <algorithm>
#include <optional>
#include <utility>

#include "base/parallel.h"
#include "diagnosis/first_look.h"
#include "diagnosis/policy.h"

namespace dynoproof::diagnosis {
namespace {

using Eigen::Index;
using Eigen::VectorXd;
using estimation::Hypothesis;

/// Puts a fit among the first, in place of one of the same model that removes less.
std::size_t InFront(std::vector<Contestant>& ranked, std::size_t kept, Contestant one) {
  const auto known = std::ranges::find(ranked, one.Name(), &Contestant::Name);
  const auto at = known - ranked.begin();
  if (known == ranked.end())
    ranked.push_back(std::move(one));
  else if (one.share > known->share)
    *known = std::move(one);
  if (at < static_cast<std::ptrdiff_t>(kept)) return kept;
  std::rotate(ranked.begin() + static_cast<std::ptrdiff_t>(kept), ranked.begin() + at, ranked.begin() + at + 1);
  return kept + 1;
}

}  // namespace

std::size_t WithPlainerLaws(std::vector<Contestant>& ranked, std::size_t kept, std::size_t first) {
  for (std::size_t i = 0; i < kept; ++i) {
    const std::string& refines = ranked[i].effect().info().traits.refines;
    const auto plainer = std::find_if(ranked.begin(), ranked.end(), [&](const Contestant& one) {
      return one.effect().info().name == refines && one.place() == ranked[i].place();
    });
    if (refines.empty() || plainer == ranked.end()) continue;
    const std::size_t level = ranked[i].Holds(first) ? first : first + 1;
    if (plainer->Holds(level) && ranked[i].Holds(level) && plainer->share < ranked[i].share) {
      const auto own = static_cast<std::ptrdiff_t>(plainer->hypothesis.of_effects());
      VectorXd& q = plainer->levels[level].q;
      q = StartFrom(plainer->hypothesis, ranked[i].hypothesis, ranked[i].levels[level].q);
      const auto count = static_cast<std::ptrdiff_t>(plainer->effect().info().parameters.size());
      for (std::ptrdiff_t k = own - count; k < own; ++k) {
        const auto number = [](const estimation::Parameter& one) { return one.name.substr(one.name.rfind(' ') + 1); };
        const estimation::Parameter& to = plainer->hypothesis.parameters()[static_cast<std::size_t>(k)];
        const auto& others = ranked[i].hypothesis.parameters();
        for (std::size_t n = 0; n < ranked[i].hypothesis.of_effects(); ++n) {
          if (number(others[n]) == number(to))
            q[k] = to.CoordinateOf(others[n].ValueAt(ranked[i].levels[level].q[static_cast<Index>(n)]));
        }
      }
    }
    if (plainer - ranked.begin() >= static_cast<std::ptrdiff_t>(kept)) {
      std::rotate(ranked.begin() + static_cast<std::ptrdiff_t>(kept), plainer, plainer + 1);
      ++kept;
    }
  }
  return kept;
}

std::size_t WithItsOtherPlaces(std::vector<Contestant>& ranked, std::size_t kept, const Contestant& null,
                               const Levels& levels, std::size_t first, const Magnitudes& magnitudes) {
  if (ranked.empty() || !ranked.front().Holds(first) || ranked.front().share < policy::kMost) return kept;
  const Contestant leader = ranked.front();
  const Effect& effect = leader.effect();
  const auto own = static_cast<Index>(leader.hypothesis.of_effects()),
             count = static_cast<Index>(effect.info().parameters.size());
  std::vector<std::pair<Hypothesis, VectorXd>> models;
  for (const Place& place : effect.Places(null.hypothesis.nominal())) {
    // A relative change is another one at another number.
    if (place.kind != leader.place().kind || !effect.ScaledParameter(place).empty()) continue;
    if (std::ranges::count(null.hypothesis.effects(), Hypothesis::Applied{&effect, place}) > 0) continue;
    const Hypothesis model = null.hypothesis.With(effect, place, magnitudes);
    const auto known = std::ranges::find(ranked, model.Name(), &Contestant::Name);
    if (known - ranked.begin() < static_cast<std::ptrdiff_t>(kept)) continue;
    VectorXd from = StartFrom(model, leader.hypothesis, leader.levels[first].q);
    for (Index k = own - count; k < own; ++k) {
      const auto i = static_cast<std::size_t>(k);
      const double value = leader.hypothesis.parameters()[i].ValueAt(leader.levels[first].q[k]);
      from[k] = model.parameters()[i].CoordinateOf(value);
    }
    models.emplace_back(model, std::move(from));
  }
  std::vector<std::optional<Contestant>> others(models.size());
  ParallelFor(models.size(), 0,
              [&](std::size_t i) { others[i] = FitOnce(models[i].first, models[i].second, null, levels, first, 2); });
  for (std::optional<Contestant>& other : others) {
    if (other->Holds(first) && 1.0 - other->share <= policy::kFarBehind * (1.0 - leader.share))
      kept = InFront(ranked, kept, *std::move(other));
  }
  return kept;
}

std::size_t WithAdmitted(std::vector<Contestant>& ranked, std::size_t kept, std::span<const Contestant> admitted,
                         const Contestant& null, const Levels& levels, std::size_t first,
                         const Magnitudes& magnitudes) {
  for (const Contestant& other : admitted) {
    if (!other.Holds(first)) continue;
    const Hypothesis model = null.hypothesis.With(other.effect(), other.place(), magnitudes);
    const VectorXd from = StartFrom(model, other.hypothesis, other.levels[first].q);
    Contestant again = FitOnce(model, from, null, levels, first, 2);
    if (!again.Holds(first)) continue;
    kept = InFront(ranked, kept, std::move(again));
  }
  return kept;
}

}  // namespace dynoproof::diagnosis
