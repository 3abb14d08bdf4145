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

/// Moves the one at `at` behind the first, which are then one more; where it is among them, nothing changes.
std::size_t MoveInFront(std::vector<Contestant>& ranked, std::size_t kept, std::ptrdiff_t at) {
  const auto end = static_cast<std::ptrdiff_t>(kept);
  if (at < end) return kept;
  std::rotate(ranked.begin() + end, ranked.begin() + at, ranked.begin() + at + 1);
  return kept + 1;
}

/// Puts a fit among the first, in place of one of the same model that removes less.
std::size_t PutInFront(std::vector<Contestant>& ranked, std::size_t kept, Contestant one) {
  const auto known = std::ranges::find(ranked, one.Name(), &Contestant::Name);
  const auto at = known - ranked.begin();
  if (known == ranked.end())
    ranked.push_back(std::move(one));
  else if (one.share > known->share)
    *known = std::move(one);
  return MoveInFront(ranked, kept, at);
}

/// Coordinates of a model by those of another one of the same machine: the numbers of its last effect by those of the same name in the other
/// model's effects, of which the last one counts, whatever law and place they are of; numbers of other names stay at `own`.
VectorXd StartByNumbersOf(const Contestant& other, const Hypothesis& model, std::size_t level, const VectorXd& own) {
  const VectorXd& known = other.levels[level].q;
  VectorXd q = StartFrom(model, other.hypothesis, known, own);
  const auto number = [](const estimation::Parameter& one) { return one.name.substr(one.name.rfind(' ') + 1); };
  const std::size_t end = model.of_effects();
  for (std::size_t k = end - model.effects().back().effect->info().parameters.size(); k < end; ++k) {
    const estimation::Parameter& to = model.parameters()[k];
    for (std::size_t n = 0; n < other.hypothesis.of_effects(); ++n) {
      const estimation::Parameter& from = other.hypothesis.parameters()[n];
      if (number(from) == number(to))
        q[static_cast<Index>(k)] = to.CoordinateOf(from.ValueAt(known[static_cast<Index>(n)]));
    }
  }
  return q;
}

}  // namespace

std::size_t WithPlainerLaws(std::vector<Contestant>& ranked, std::size_t kept, std::size_t first) {
  for (std::size_t i = 0; i < kept; ++i) {
    for (const std::string& refined : ranked[i].effect().info().traits.refines) {
      const auto plainer = std::find_if(ranked.begin(), ranked.end(), [&](const Contestant& one) {
        return one.effect().info().name == refined && one.place() == ranked[i].place();
      });
      if (plainer == ranked.end()) continue;
      const std::size_t level = ranked[i].Holds(first) ? first : first + 1;
      if (plainer->Holds(level) && ranked[i].Holds(level) && plainer->share < ranked[i].share)
        plainer->levels[level].q = StartByNumbersOf(ranked[i], plainer->hypothesis, level, plainer->levels[level].q);
      kept = MoveInFront(ranked, kept, plainer - ranked.begin());
    }
  }
  return kept;
}

std::size_t WithItsOtherPlaces(std::vector<Contestant>& ranked, std::size_t kept, const Contestant& null,
                               const Levels& levels, std::size_t first, const Magnitudes& magnitudes) {
  if (ranked.empty() || !ranked.front().Holds(first) || ranked.front().share < policy::kMost) return kept;
  const Contestant leader = ranked.front();
  const Effect& effect = leader.effect();
  std::vector<std::pair<Hypothesis, VectorXd>> models;
  for (const Place& place : effect.Places(null.hypothesis.nominal())) {
    // A relative change is another one at another number.
    if (!effect.ScaledParameter(place).empty()) continue;
    if (std::ranges::count(null.hypothesis.effects(), Hypothesis::Applied{&effect, place}) > 0) continue;
    const Hypothesis model = null.hypothesis.With(effect, place, magnitudes);
    const auto known = std::ranges::find(ranked, model.Name(), &Contestant::Name);
    if (known - ranked.begin() < static_cast<std::ptrdiff_t>(kept)) continue;
    models.emplace_back(model, StartByNumbersOf(leader, model, first, model.start()));
  }
  std::vector<std::optional<Contestant>> others(models.size());
  ParallelFor(models.size(), 0,
              [&](std::size_t i) { others[i] = FitOnce(models[i].first, models[i].second, null, levels, first, 2); });
  for (std::optional<Contestant>& other : others) {
    if (other->Holds(first) && 1.0 - other->share <= policy::kFarBehind * (1.0 - leader.share))
      kept = PutInFront(ranked, kept, *std::move(other));
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
    kept = PutInFront(ranked, kept, std::move(again));
  }
  return kept;
}

}  // namespace dynoproof::diagnosis
