#include "diagnosis/contest.h"

#include <algorithm>

#include "diagnosis/carried_along.h"
#include "diagnosis/carry.h"
#include "diagnosis/first_look.h"
#include "diagnosis/policy.h"

namespace dynoproof::diagnosis {

using estimation::Hypothesis;

Hypothesis NullHypothesis(const Plan& plan, bool released, const Levels& levels, const Registry& registry) {
  const Hypothesis base(plan);
  Hypothesis free = released ? base.WithNominalValuesReleased(registry) : base.WithNominalValuesFree(registry);
  for (std::size_t r = 0; r < levels.data().records().size(); ++r) free = free.WithStartFree(r, registry);
  return free.WithDifferencesFree(levels.data().records().size());
}

void FitAlong(Contestant& one, const Levels& levels, Eigen::VectorXd from) {
  // From near by: let go, a model that lacks its effect has no truth to go to, and what it finds first is nearer to the plan as
  // given than what a thorough search would find.
  const estimation::EstimatorOptions how{.renewals = 6, .points = PointsFor(one.hypothesis), .near = true};
  const Eigen::VectorXd given = from;
  one.levels.resize(levels.size());
  for (estimation::Estimate& fit : one.levels) fit.broken = "not fitted";
  for (std::size_t level = 0; level < levels.size(); ++level) {
    estimation::Estimate& fit = one.levels[level];
    fit.broken = SteppedOver(one, levels, level);
    if (!fit.ok()) continue;
    fit = estimation::Fit(one.hypothesis, levels[level], from, how);
    const bool free = level == levels.free_run();
    if (free && fit.ok() && !IsExact(fit) && LogLeftAt(given, one.hypothesis, levels, level) < LogLeft(fit, levels))
      fit = estimation::Fit(one.hypothesis, levels[level], given, how);
    if (fit.ok()) from = fit.q;
  }
}

Contestant NullOf(const Plan& plan, bool released, const Levels& levels, const Registry& registry) {
  Contestant null(NullHypothesis(plan, released, levels, registry));
  FitAlong(null, levels, null.hypothesis.start());
  const estimation::Estimate& free = null.levels[levels.free_run()];
  for (std::size_t level = 0; level < levels.free_run() && free.ok(); ++level) {
    estimation::Estimate& fit = null.levels[level];
    if (fit.ok() && TimesNoise(fit) > policy::kAmplifies * std::max(1.0, TimesNoise(free)))
      fit.broken = "the record corrects away from itself what the free run has right";
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
  Looked looked = FirstLook(null, levels, contest.first, magnitudes, registry, part, {.until_exact = true});
  std::vector<Contestant>& ranked = looked.ranked;
  contest.silent = std::move(looked.silent);
  std::size_t kept =
      std::min(null.hypothesis.effects().empty() ? policy::kCarried : policy::kCarriedOnTop, ranked.size());
  kept = WithPlainerLaws(ranked, kept, contest.first);
  kept = WithItsOtherPlaces(ranked, kept, null, levels, contest.first, magnitudes);
  kept = WithAdmitted(ranked, kept, admitted, null, levels, contest.first, magnitudes);
  count("first look");
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
