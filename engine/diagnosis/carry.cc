#include "diagnosis/carry.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/parallel.h"
#include "diagnosis/policy.h"
#include "diagnosis/weights.h"

namespace dynoproof::diagnosis {
namespace {

using Eigen::Index;
using Eigen::VectorXd;
using estimation::ChannelScale;
using estimation::Estimate;
using estimation::Fit;
using estimation::Hypothesis;
using estimation::Prediction;

/// Takes another fit at a level where that leaves less than the one there.
void TakeLower(Contestant& contestant, Estimate again, const Levels& levels, std::size_t level) {
  if (again.ok() && (!contestant.Holds(level) || LogLeft(again, levels) < LogLeft(contestant.levels[level], levels)))
    contestant.levels[level] = std::move(again);
}

/// Where a fit begins at a level: where the level before has come to, where a first look has come to here, or at the null's
/// values of this level, whichever leaves least. Where all are worse than the null itself, it begins there, with an effect that
/// does next to nothing.
VectorXd BestStart(const Contestant& contestant, const Contestant& null, const Levels& levels, std::size_t level,
                   VectorXd from) {
  if (!null.Holds(level)) return from;
  const Hypothesis& hypothesis = contestant.hypothesis;
  const auto own = static_cast<Index>(hypothesis.of_effects());
  const auto excess = [&](const VectorXd& q) {
    const Result<VectorXd> rows = levels[level].Innovations(hypothesis.At(q));
    if (!rows.ok()) return std::numeric_limits<double>::infinity();
    return LogExcess(estimation::ScalesOf(levels.data(), *rows, NoiseAloneOf(null.levels[level])), levels.data());
  };
  double of_from = excess(from);
  if (contestant.Holds(level)) {
    const VectorXd& looked = contestant.levels[level].q;
    const double of_looked = excess(looked);
    if (of_looked < of_from) from = looked, of_from = of_looked;
  }
  VectorXd here = StartFrom(hypothesis, null.hypothesis, null.levels[level].q);
  const auto count = static_cast<Index>(contestant.effect().info().parameters.size());
  here.segment(own - count, count) = from.segment(own - count, count);
  const double of_here = excess(here);
  if (std::min(of_from, of_here) <= LogLeft(null.levels[level], levels)) return of_from <= of_here ? from : here;
  constexpr double kNextToNothing = 0.01;  // of where it was
  for (Index i = own - count; i < own; ++i) {
    const estimation::Parameter& parameter = hypothesis.parameters()[static_cast<std::size_t>(i)];
    if (!parameter.neutral) continue;
    const double neutral = parameter.CoordinateOf(*parameter.neutral);
    here[i] = neutral + kNextToNothing * (from[i] - neutral);
  }
  return here;
}

/// Once more from the values that another model has found, where that ends lower.
void FitFrom(Contestant& contestant, const Contestant& other, const Contestant& null, const Levels& levels,
             std::size_t level) {
  constexpr double kWorth = 1e-3;  // of the logarithm of the excess
  if (!other.Holds(level)) return;
  // Its own effects keep their numbers where the other model has none of these.
  VectorXd from = contestant.hypothesis.start();
  if (contestant.Holds(level))
    from.head(static_cast<Index>(contestant.hypothesis.of_effects())) =
        contestant.levels[level].q.head(static_cast<Index>(contestant.hypothesis.of_effects()));
  from = StartFrom(contestant.hypothesis, other.hypothesis, other.levels[level].q, from);
  // Its own columns do for a few steps; only what ends lower is worth new ones.
  const bool known = contestant.Holds(level);
  const estimation::KnownColumns own_columns{&contestant.hypothesis, known ? &contestant.levels[level] : nullptr};
  Estimate again = AsLoudAs(null, level,
                            Fit(contestant.hypothesis, levels[level], from,
                                {.iterations = 8,
                                 .renewals = 1,
                                 .of_excess = policy::kCarriedTo,
                                 .near = true,
                                 .known = known ? std::optional(own_columns) : std::nullopt}));
  if (!again.ok() || (known && !(LogLeft(again, levels) < LogLeft(contestant.levels[level], levels) - kWorth))) return;
  if (known && !IsFarBehind(again, &other, levels, level)) again = FitFully(contestant, null, levels, level, again.q);
  if (again.ok()) contestant.levels[level] = std::move(again);
}

/// The last level before one that a contestant has reached.
std::optional<std::size_t> ReachedBefore(const Contestant& contestant, std::size_t level) {
  while (level-- > 0) {
    if (contestant.Holds(level)) return level;
  }
  return std::nullopt;
}

/// Fits the null from the level before, where it has come to a better minimum than the one from which it was led on; kept where lower.
void GoOn(Contestant& null, const Levels& levels, std::size_t level) {
  const std::optional<std::size_t> before = ReachedBefore(null, level);
  if (!before) return;
  TakeLower(null, FitFully(null, null, levels, level, null.levels[*before].q), levels, level);
}

/// Fits the level before once more from the values of this one, where it ended above the null and that ends lower.
void LookBack(Contestant& contestant, const Contestant& null, const Levels& levels, std::size_t level) {
  const std::size_t before = level - 1;
  if (!contestant.Holds(level) || !contestant.Holds(before) || !null.Holds(before)) return;
  if (ShareOf(contestant, null, levels, before) >= policy::kHarm) return;
  TakeLower(contestant, FitFully(contestant, null, levels, before, contestant.levels[level].q), levels, before);
}

/// Whether the free run at what a fit has come to leaves no more than the fit did: then it needs no longer memory to go there.
bool ReachesTheFreeRun(const Contestant& contestant, const Levels& levels, std::size_t level) {
  const Estimate& fit = contestant.levels[level];
  const Result<Prediction> there = levels[levels.free_run()].Predict(contestant.hypothesis.At(fit.q));
  if (!there.ok()) return false;
  const std::vector<ChannelScale> scales = estimation::ScalesOf(levels.data(), there->innovations, there->noise_alone);
  const auto power = [](const ChannelScale& one) { return std::pow(one.rms / one.noise_alone, 2); };
  return std::ranges::equal(scales, fit.scales, [&](const ChannelScale& free, const ChannelScale& here) {
    return power(free) <= std::max(1.0, power(here)) + policy::kNoiseKnown;
  });
}

/// Why nobody follows a contestant beyond a level; empty: it is followed.
std::vector<std::string> LeftAt(std::span<const Contestant> contestants, const Levels& levels, std::size_t first,
                                std::size_t level) {
  std::vector<std::string> why(contestants.size());
  const Contestant& null = contestants.front();
  const auto share = [&](const Contestant& one, std::size_t at) {
    return one.Holds(at) && null.Holds(at) ? ShareOf(one, null, levels, at) : -std::numeric_limits<double>::infinity();
  };
  double most = 0.0;
  for (const Contestant& one : contestants) most = std::max(most, share(one, level));
  const bool found =
      level > 0 && std::ranges::any_of(contestants, [&](const Contestant& one) {
        return one.Holds(level) && IsExact(one.levels[level]) && IsQuiet(one.levels[level], levels.data());
      });
  std::optional<Weights> weights;
  if (found) weights.emplace(contestants, levels, level, RowsCount::kByBlock);
  for (std::size_t i = 1; i < contestants.size(); ++i) {
    const Contestant& one = contestants[i];
    double own = -std::numeric_limits<double>::infinity();
    for (std::size_t at = first; at <= level; ++at) own = std::max(own, share(one, at));
    if (level > first && most >= policy::kMost && own < policy::kLittle)
      why[i] = fmt::format("removes next to nothing up to {}", levels.Name(level));
    if (!found || !one.Holds(level) || IsExact(one.levels[level])) continue;
    for (std::size_t k = 0; k < contestants.size(); ++k) {
      // A law contains the plainer one that it refines, and beats it where a fit of that has ended early: the verdict weighs the two.
      if (Refines(contestants[k], one) && IsNearTheNoise(one.levels[level])) continue;
      if (contestants[k].Holds(level) && IsExact(contestants[k].levels[level]) && weights->Beats(k, i))
        why[i] = fmt::format("beaten at {} by {}, which leaves nothing but noise", levels.Name(level),
                             contestants[k].Name());
    }
  }
  return why;
}

/// Continues the fits of models near the best one that had ended before they had settled: what such a fit still has to gain may be more than
/// what tells two models apart. Where the best leaves nothing but noise, no fit is continued: the others then leave as little, or are beaten.
void SettleThose(std::span<Contestant> contestants, const Levels& levels, std::size_t level) {
  const Contestant* leader = LeaderAt(contestants, levels, level);
  if (leader == nullptr || IsExact(leader->levels[level])) return;
  const Contestant ahead = *leader, null = contestants.front();
  ParallelFor(contestants.size(), 0, [&](std::size_t i) {
    Contestant& own = contestants[i];
    if (!own.Holds(level) || IsFarBehind(own.levels[level], &ahead, levels, level)) return;
    if (own.levels[level].termination == estimation::kSettled) return;
    Estimate again =
        AsLoudAs(null, level,
                 Fit(own.hypothesis, levels[level], own.levels[level].q,
                     {.renewals = 6,
                      .points = policy::kRoughPoints + static_cast<int>(own.hypothesis.parameters().size()),
                      .of_excess = policy::kCarriedTo,
                      .near = true,
                      .patient = true}));
    TakeLower(own, std::move(again), levels, level);
  });
}

}  // namespace

Estimate FitRoughly(const Contestant& contestant, const Contestant& null, const Levels& levels, std::size_t level,
                    const VectorXd& from, const std::optional<estimation::KnownColumns>& known) {
  return AsLoudAs(null, level,
                  Fit(contestant.hypothesis, levels[level], from,
                      {.iterations = 10,
                       .renewals = 2,
                       .points = policy::kRoughPoints,
                       .of_excess = policy::kCarriedTo,
                       .near = true,
                       .known = known}));
}

Estimate FitFully(const Contestant& contestant, const Contestant& null, const Levels& levels, std::size_t level,
                  const VectorXd& from) {
  return AsLoudAs(
      null, level,
      Fit(contestant.hypothesis, levels[level], from,
          {.renewals = 6, .points = PointsFor(contestant.hypothesis), .of_excess = policy::kCarriedTo, .near = true}));
}

bool IsFarBehind(const Estimate& estimate, const Contestant* leader, const Levels& levels, std::size_t level) {
  if (!estimate.ok() || leader == nullptr) return false;
  return LogLeft(estimate, levels) > LogLeft(leader->levels[level], levels) + std::log(policy::kFarBehind);
}

std::string SteppedOver(const Contestant& contestant, const Levels& levels, std::size_t level) {
  const std::optional<std::size_t> before = ReachedBefore(contestant, level);
  if (!levels.IsSteppingStone(level) || !before) return "";
  if (!IsNearTheNoise(contestant.levels[*before])) return "far from the noise before";
  return ReachesTheFreeRun(contestant, levels, *before) ? "the free run is reached without" : "";
}

bool Carry(std::span<Contestant> contestants, const Levels& levels, std::size_t first, const Conduct& conduct) {
  std::vector<VectorXd> from;
  for (const Contestant& one : contestants) from.push_back(one.levels[one.Holds(first) ? first : first + 1].q);
  std::vector<std::string> left(contestants.size());
  bool null_found = false;  // a minimum near the noise, by another's values
  for (std::size_t level = first; level < levels.size(); ++level) {
    if (conduct.spent()) return false;
    std::vector<std::string> over(contestants.size());
    ParallelFor(contestants.size(), 0, [&](std::size_t i) {
      over[i] = left[i].empty() ? SteppedOver(contestants[i], levels, level) : left[i];
    });
    const auto follows = [&](std::size_t i) { return over[i].empty(); };
    if (null_found && follows(0)) GoOn(contestants.front(), levels, level);
    const Contestant null = contestants.front();
    ParallelFor(contestants.size(), 0, [&](std::size_t i) {
      if (i == 0) return;
      Contestant& own = contestants[i];
      if (!follows(i)) {
        own.levels[level].broken = over[i];
        return;
      }
      const std::optional<VectorXd> saved = conduct.Recall(own.Name(), level, from[i].size());
      const VectorXd start = saved ? *saved : BestStart(own, null, levels, level, from[i]);
      // Columns of a null that is far from the noise lead a model astray that is near it: its own of the level before are nearer.
      const std::optional<std::size_t> before = ReachedBefore(own, level);
      std::optional<estimation::KnownColumns> known;
      if (level > first && before && IsNearTheNoise(own.levels[*before]))
        known = {&own.hypothesis, &own.levels[*before]};
      else if (null.Holds(level))
        known = {&null.hypothesis, &null.levels[level]};
      own.levels[level] = FitRoughly(own, null, levels, level, start, known);
    });
    const Contestant* first_of_all = LeaderAt(contestants, levels, level);
    const std::optional<Contestant> ahead = first_of_all != nullptr ? std::optional(*first_of_all) : std::nullopt;
    ParallelFor(contestants.size(), 0, [&](std::size_t i) {
      Estimate& rough = contestants[i].levels[level];
      if (i == 0 || !follows(i) || !rough.ok()) return;
      if (IsFarBehind(rough, ahead ? &*ahead : nullptr, levels, level)) return;
      Estimate full = FitFully(contestants[i], null, levels, level, rough.q);
      if (full.ok()) rough = std::move(full);
    });
    const Contestant* leader = LeaderAt(contestants, levels, level);
    if (leader != nullptr && !levels.IsSteppingStone(level)) {
      ParallelFor(contestants.size(), 0, [&](std::size_t i) {
        Contestant& own = contestants[i];
        if (&own != leader && follows(i)) FitFrom(own, *leader, null, levels, level);
      });
      const Estimate& now = contestants.front().levels[level];
      const bool moved = now.ok() && (!null.Holds(level) || now.q != null.levels[level].q);
      null_found = null_found || (moved && IsNearTheNoise(now));
    }
    // Where a fit has ended above the null, what it has come to here may be the better start there.
    ParallelFor(contestants.size(), 0, [&](std::size_t i) {
      if (i > 0 && level > first) LookBack(contestants[i], null, levels, level);
    });
    for (std::size_t i = 1; i < contestants.size(); ++i) {
      if (!contestants[i].Holds(level)) continue;
      from[i] = contestants[i].levels[level].q;
      conduct.Keep(contestants[i].Name(), level, from[i]);
    }
    std::vector<std::string> now = LeftAt(contestants, levels, first, level);
    for (std::size_t i = 0; i < now.size(); ++i) {
      if (left[i].empty()) left[i] = std::move(now[i]);
    }
    if (!levels.IsSteppingStone(level)) SettleThose(contestants, levels, level);
    conduct.progress(static_cast<double>(level - first + 1) / static_cast<double>(levels.size() - first));
  }
  return true;
}

}  // namespace dynoproof::diagnosis
