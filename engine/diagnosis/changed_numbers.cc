#include "diagnosis/changed_numbers.h"

#include <algorithm>
#include <bit>
#include <cmath>

#include "base/parallel.h"
#include "diagnosis/policy.h"
#include "diagnosis/trial.h"

namespace dynoproof::diagnosis {
namespace {

using Eigen::Index;
using Eigen::VectorXd;
using estimation::Hypothesis;

struct Change {
  Trial trial;
  double relative;  // value over nominal - 1
};

/// Whether nothing shows beside the noise. Several numbers follow much that is not theirs: an exact model of them alone may leave no fifth
/// of its power more, as others may.
bool LeavesNothing(const Contestant& one, const Levels& levels) {
  const std::size_t level = levels.free_run();
  return one.Holds(level) && IsExact(one.levels[level]) && !HasExcess(one.levels[level], levels.data());
}

/// Which of a fitted model's numbers that is; nothing where it has none of that name.
std::optional<std::size_t> IndexIn(const Contestant& one, const std::string& path) {
  const auto& parameters = one.hypothesis.parameters();
  const auto own = std::ranges::find(parameters, path, &estimation::Parameter::name);
  return own != parameters.end() ? std::optional(static_cast<std::size_t>(own - parameters.begin())) : std::nullopt;
}

double ValueAt(const Contestant& one, std::size_t number, std::size_t level) {
  return one.hypothesis.parameters()[number].ValueAt(one.levels[level].q[static_cast<Eigen::Index>(number)]);
}

std::vector<Change> ChangesOf(const Contestant& exact, const Contestant& null, const Levels& levels,
                              const Magnitudes& magnitudes, const Registry& registry) {
  std::vector<Change> changes;
  const std::vector<std::pair<std::string, double>> far = FarFromPriors(exact, null, levels);
  for (Trial& trial : TrialsOf(null.hypothesis, levels, magnitudes, registry)) {
    const std::string scaled = trial.effect->ScaledIn(null.hypothesis.nominal(), trial.place);
    if (std::ranges::find(far, scaled, &std::pair<std::string, double>::first) == far.end()) continue;
    const double nominal = null.hypothesis.nominal().root.NumberOr(scaled, 0.0);
    changes.push_back({std::move(trial), ValueAt(exact, *IndexIn(exact, scaled), levels.free_run()) / nominal - 1.0});
  }
  return changes;
}

/// The model with some of the changes, from the values of the exact one, fitted in the free run.
Contestant WithChanges(const std::vector<Change>& changes, std::uint64_t chosen, const Contestant& exact,
                       const Contestant& null, const Levels& levels, const Magnitudes& magnitudes) {
  const std::size_t level = levels.free_run();
  Hypothesis hypothesis = null.hypothesis;
  std::vector<double> sizes;
  for (std::size_t i = 0; i < changes.size(); ++i) {
    if ((chosen >> i & 1U) == 0) continue;
    hypothesis = hypothesis.With(*changes[i].trial.effect, changes[i].trial.place, magnitudes);
    sizes.push_back(changes[i].relative);
  }
  Contestant one(hypothesis);
  one.levels.resize(levels.size());
  for (estimation::Estimate& fit : one.levels) fit.broken = "looked at in the free run alone";
  // The other numbers are near their nominal values, or where they have come to with all of them free.
  for (VectorXd start : {hypothesis.start(), StartFrom(hypothesis, exact.hypothesis, exact.levels[level].q)}) {
    for (std::size_t i = 0; i < sizes.size(); ++i)
      start[static_cast<Index>(i)] = hypothesis.parameters()[i].CoordinateOf(sizes[i]);
    const estimation::EstimatorOptions how{
        .renewals = 6, .points = PointsFor(hypothesis), .of_excess = policy::kCarriedTo, .near = true};
    estimation::Estimate fit = AsLoudAs(null, level, estimation::Fit(hypothesis, levels[level], start, how));
    if (fit.ok() && (!one.Holds(level) || LogLeft(fit, levels) < LogLeft(one.levels[level], levels)))
      one.levels[level] = std::move(fit);
    if (LeavesNothing(one, levels)) break;
  }
  return one;
}

}  // namespace

std::optional<Contestant> ByNumbersAlone(const Contestant& null, const Contestant& released, const Levels& levels) {
  const std::size_t level = levels.free_run();
  if (LeavesNothing(released, levels)) return released;
  double share = 0.0;
  for (std::size_t at = 0; at < levels.size(); ++at) {
    if (null.Holds(at) && released.Holds(at)) share = std::max(share, ShareOf(released, null, levels, at));
  }
  if (share < policy::kNumbersAlone) return std::nullopt;
  Contestant one(released.hypothesis);
  const int points = policy::kThoroughSteps * (1 + static_cast<int>(one.hypothesis.parameters().size()));
  one.levels.resize(levels.size());
  for (estimation::Estimate& fit : one.levels) fit.broken = "not fitted";
  VectorXd from = one.hypothesis.start();
  for (const std::size_t at : {std::size_t{0}, level}) {
    estimation::Estimate& fit = one.levels[at];
    fit = estimation::Fit(one.hypothesis, levels[at], from, {.renewals = 6, .points = points});
    if (!fit.ok() || !IsNearTheNoise(fit)) return std::nullopt;
    from = fit.q;
  }
  return LeavesNothing(one, levels) ? std::optional(std::move(one)) : std::nullopt;
}

std::vector<std::pair<std::string, double>> FarFromPriors(const Contestant& exact, const Contestant& null,
                                                          const Levels& levels) {
  constexpr double kFar = 3.0;  // deviations: what the priors' bounds allow
  std::vector<std::pair<std::string, double>> far;
  for (const estimation::Parameter& parameter : null.hypothesis.parameters()) {
    if (!parameter.prior || parameter.name.starts_with("of_record.")) continue;
    const std::optional<std::size_t> own = IndexIn(exact, parameter.name);
    if (!own || !Shows(exact.levels[levels.free_run()], *own)) continue;
    const double off = parameter.CoordinateOf(ValueAt(exact, *own, levels.free_run()));
    if (std::abs(off) > kFar) far.emplace_back(parameter.name, off);
  }
  std::ranges::stable_sort(far, {}, [](const auto& one) { return -std::abs(one.second); });
  return far;
}

Contest CompeteByChanges(const Contest& under_priors, const Contestant& exact, const Levels& levels,
                         const Magnitudes& magnitudes, const Registry& registry, std::size_t most) {
  Contest contest;
  contest.first = under_priors.first;
  contest.contestants.push_back(under_priors.null());
  const std::vector<Change> changes = ChangesOf(exact, under_priors.null(), levels, magnitudes, registry);
  if (changes.size() > policy::kMostChanges) return contest;
  for (std::size_t count = 1; count <= most && contest.contestants.size() == 1; ++count) {
    std::vector<std::uint64_t> sets;
    for (std::uint64_t chosen = 1; chosen < (std::uint64_t{1} << changes.size()); ++chosen) {
      if (static_cast<std::size_t>(std::popcount(chosen)) == count) sets.push_back(chosen);
    }
    std::vector<std::optional<Contestant>> fitted(sets.size());
    ParallelFor(sets.size(), 0, [&](std::size_t i) {
      fitted[i] = WithChanges(changes, sets[i], exact, under_priors.null(), levels, magnitudes);
    });
    for (std::optional<Contestant>& one : fitted) {
      if (!LeavesNothing(*one, levels)) continue;
      // An interval is told of the estimate, and holds about a minimum alone.
      estimation::Estimate& fit = one->levels[levels.free_run()];
      estimation::Estimate last = AsLoudAs(under_priors.null(), levels.free_run(),
                                           estimation::Fit(one->hypothesis, levels[levels.free_run()], fit.q));
      if (last.ok() && LogLeft(last, levels) <= LogLeft(fit, levels)) fit = std::move(last);
      contest.contestants.push_back(*std::move(one));
    }
  }
  return contest;
}

}  // namespace dynoproof::diagnosis
