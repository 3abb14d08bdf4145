#include "diagnosis/contest.h"

#include <algorithm>

#include "diagnosis/carry.h"
#include "diagnosis/first_look.h"
#include "diagnosis/policy.h"

namespace dynoproof::diagnosis {
namespace {

using Eigen::Index;
using Eigen::VectorXd;
using estimation::Hypothesis;

/// A law is carried with the plainer one that it refines at its place, from the same values: of the two the plainer one is
/// named where it does. Both stand among the first, of which there are as many as is told.
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

/// A null that was let go has swallowed some of its missing effect: at the short memory of a first look another one may remove more of what
/// is left. What was admitted beside the nominal values is compared in any case.
std::size_t WithAdmitted(std::vector<Contestant>& ranked, std::size_t kept, std::span<const Contestant> admitted,
                         const Contestant& null, const Levels& levels, std::size_t first,
                         const Magnitudes& magnitudes) {
  for (const Contestant& other : admitted) {
    if (!other.Holds(first)) continue;
    const Hypothesis model = null.hypothesis.With(other.effect(), other.place(), magnitudes);
    const VectorXd from = StartFrom(model, other.hypothesis, other.levels[first].q);
    Contestant again = FitOnce(model, from, null, levels, first, 2);
    if (!again.Holds(first)) continue;
    const auto known = std::ranges::find(ranked, again.Name(), &Contestant::Name);
    const auto at = known - ranked.begin();
    if (known == ranked.end())
      ranked.push_back(std::move(again));
    else if (again.share > known->share)
      *known = std::move(again);
    if (at < static_cast<std::ptrdiff_t>(kept)) continue;
    std::rotate(ranked.begin() + static_cast<std::ptrdiff_t>(kept), ranked.begin() + at, ranked.begin() + at + 1);
    ++kept;
  }
  return kept;
}

}  // namespace

Hypothesis NullHypothesis(const Plan& plan, bool released, const Levels& levels, const Registry& registry) {
  const Hypothesis base(plan);
  Hypothesis free = released ? base.WithNominalValuesReleased(registry) : base.WithNominalValuesFree(registry);
  for (std::size_t r = 0; r < levels.data().records().size(); ++r) free = free.WithStartFree(r, registry);
  return free.WithDifferencesFree(levels.data().records().size());
}

Contestant NullOf(const Plan& plan, bool released, const Levels& levels, const Registry& registry) {
  Contestant null(NullHypothesis(plan, released, levels, registry));
  // From near by: let go, a model that lacks its effect has no truth to go to, and what it finds first is nearer to the plan as
  // given than what a thorough search would find.
  const estimation::EstimatorOptions how{.renewals = 6, .points = PointsFor(null.hypothesis), .near = true};
  VectorXd from = null.hypothesis.start();
  null.levels.resize(levels.size());
  for (estimation::Estimate& fit : null.levels) fit.broken = "not fitted";
  for (std::size_t level = 0; level < levels.size(); ++level) {
    estimation::Estimate& fit = null.levels[level];
    fit.broken = SteppedOver(null, levels, level);
    if (!fit.ok()) continue;
    fit = estimation::Fit(null.hypothesis, levels[level], from, how);
    if (fit.ok()) from = fit.q;
  }
  return null;
}

Result<Contest> Compete(Contestant null, bool released, const Levels& levels, const Magnitudes& magnitudes,
                        const Registry& registry, const Conduct& conduct, std::span<const Contestant> admitted) {
  Contest contest;
  contest.released = released;
  std::int64_t counted = levels.simulations();
  const auto count = [&](const char* stage) {
    contest.cost.push_back({stage, levels.simulations() - counted});
    counted = levels.simulations();
  };
  // The most corrected level at which anything is left to explain; the free run where nowhere is.
  contest.first = levels.size();
  for (std::size_t level = 0; level < levels.size(); ++level) {
    if (!null.Holds(level)) continue;
    contest.first = level;
    if (HasExcess(null.levels[level], levels.data())) break;
  }
  if (contest.first == levels.size())
    return Failure{"the nominal model breaks beside the record: " + null.levels.front().broken,
                   null.hypothesis.nominal().id};
  Conduct part = conduct;
  part.progress = [&](double share) { conduct.progress(0.1 + 0.4 * share); };
  part.progress(0.0);
  Looked looked = FirstLook(null, levels, contest.first, magnitudes, registry, part);
  std::vector<Contestant>& ranked = looked.ranked;
  contest.silent = std::move(looked.silent);
  std::size_t kept =
      std::min(null.hypothesis.effects().empty() ? policy::kCarried : policy::kCarriedOnTop, ranked.size());
  kept = WithAdmitted(ranked, kept, admitted, null, levels, contest.first, magnitudes);
  count("first look");
  kept = WithPlainerLaws(ranked, kept, contest.first);
  contest.contestants.push_back(std::move(null));
  for (std::size_t i = 0; i < ranked.size(); ++i)
    (i < kept ? contest.contestants : contest.left_behind).push_back(std::move(ranked[i]));
  part.progress = [&](double share) { conduct.progress(0.5 + 0.5 * share); };
  contest.complete = Carry(contest.contestants, levels, contest.first, part);
  count("through the levels");
  conduct.progress(1.0);
  return contest;
}

}  // namespace dynoproof::diagnosis
