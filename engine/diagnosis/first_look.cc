#include "diagnosis/first_look.h"

#include <algorithm>
#include <atomic>
#include <functional>
#include <optional>
#include <span>
#include <string>

#include "base/parallel.h"
#include "diagnosis/carry.h"
#include "diagnosis/policy.h"
#include "diagnosis/sketch.h"

namespace dynoproof::diagnosis {
namespace {

using Eigen::Index;
using Eigen::VectorXd;
using estimation::Estimate;
using estimation::Fit;

/// How many of the sketches, in this order, are worth a fit. Where the null leaves an excess, as many as are affordable. Where
/// it leaves none, those whose score test (Rao 1948) says that they remove more than noise lets a candidate remove by chance,
/// and the first few in any case, for the report.
std::size_t WorthFitting(const Contestant& null, const Levels& levels, std::size_t level,
                         const std::vector<std::size_t>& order, const std::vector<Sketch>& sketches, std::size_t most) {
  const Estimate& estimate = null.levels[level];
  if (HasExcess(estimate, levels.data())) return most;
  const double squares = SquaresOf(null, level);  // of rows that noise alone makes about one each, and of deviations
  const auto chance =
      std::ranges::find_if(order, [&](std::size_t i) { return sketches[i].removes * squares < policy::kByChance; });
  return std::clamp<std::size_t>(static_cast<std::size_t>(chance - order.begin()), policy::kLookedAtLeast, most);
}

/// Whether what a look has found leaves nothing but noise in the free run, once it is fitted there.
bool IsExactInFreeRun(const Contestant& one, const Contestant& null, const Levels& levels, std::size_t level) {
  const std::size_t free = levels.free_run(), last = one.Holds(level + 1) ? level + 1 : level;
  if (!one.Holds(last) || one.share < policy::kNearlyAll) return false;
  if (last == free && IsExact(one.levels[free])) return true;
  Estimate there = FitRoughly(one, null, levels, free, one.levels[last].q, std::nullopt);
  if (there.ok() && !IsExact(there) && IsNearTheNoise(there))
    there = FitFully(one, null, levels, free, Eigen::VectorXd(there.q));
  return there.ok() && IsExact(there);
}

/// A candidate that was not fitted, where its sketch is.
Contestant NotFitted(const Trial& candidate, const Sketch& sketch, const Levels& levels) {
  Contestant one(candidate.hypothesis);
  one.levels.resize(levels.size());
  for (Estimate& estimate : one.levels) {
    estimate.broken = "not fitted: another one leaves nothing but noise";
    estimate.q = sketch.q;
  }
  one.share = std::max(0.0, sketch.removes);
  return one;
}

/// Works on `count` in parts, between which `ended` says whether that is enough, and tells the progress, from a share of all work to another.
void InParts(std::size_t count, double from, double to, const Conduct& conduct,
             const std::function<bool(std::size_t)>& ended, const std::function<void(std::size_t)>& work) {
  constexpr std::size_t kAtOnce = 16;
  std::atomic<std::size_t> done = 0;
  for (std::size_t begin = 0; begin < count && !ended(begin); begin += kAtOnce) {
    ParallelFor(std::min(kAtOnce, count - begin), 0, [&](std::size_t i) {
      work(begin + i);
      conduct.progress(from + (to - from) * static_cast<double>(++done) / static_cast<double>(count));
    });
  }
}

constexpr double kSketched = 0.6;  // of the work

/// What each candidate promises beside the null, from an interrupted search where that knows it.
std::vector<Sketch> SketchesOf(const std::vector<Trial>& candidates, const Screens& screens, const Contestant& null,
                               std::size_t level, const Conduct& conduct) {
  constexpr Index kBeside = 3;  // of a sketch beside its coordinates
  std::vector<Sketch> sketches(candidates.size());
  const auto spent = [&](std::size_t) { return conduct.spent(); };
  InParts(candidates.size(), 0.0, kSketched, conduct, spent, [&](std::size_t i) {
    const VectorXd from = StartFrom(candidates[i].hypothesis, null.hypothesis, null.levels[level].q);
    const std::string name = candidates[i].hypothesis.Name() + ", first look";
    if (const std::optional<VectorXd> known = conduct.Recall(name, level, from.size() + kBeside))
      sketches[i] = {known->head(from.size()), known->tail(3)[0], known->tail(2)[0], known->tail(1)[0]};
    else
      sketches[i] = SketchOf(candidates[i], screens, from);
    VectorXd kept(from.size() + kBeside);
    kept << sketches[i].q, sketches[i].removes, sketches[i].moves.value_or(policy::kUnseen),
        sketches[i].next.value_or(1.0);
    conduct.Keep(name, level, kept);
  });
  return sketches;
}

/// Those worth a fit, what promises most first.
std::vector<std::size_t> Promising(const Contestant& null, const Levels& levels, std::size_t level,
                                   const std::vector<Sketch>& sketches, std::size_t most) {
  std::vector<std::size_t> order;
  for (std::size_t i = 0; i < sketches.size(); ++i) {
    if (sketches[i].removes >= 0.0) order.push_back(i);
  }
  std::ranges::stable_sort(order, std::ranges::greater(), [&](std::size_t i) { return sketches[i].removes; });
  order.resize(std::min(order.size(), WorthFitting(null, levels, level, order, sketches, most)));
  return order;
}

/// Follows the best of what was fitted: where it leads to the noise, the others need no fit.
class Follower {
 public:
  Follower(const Contestant& null, const Levels& levels, std::size_t level, bool asked)
      : null_(null), levels_(levels), level_(level) {
    const std::size_t free = levels.free_run();
    follows_ = asked && !(null.Holds(free) && IsExact(null.levels[free]));
  }

  /// Whether the best of these is exact; one that was asked for before is not asked for again.
  bool Arrives(std::span<const std::optional<Contestant>> fitted) {
    if (!follows_ || fitted.empty()) return false;
    const auto share = [](const std::optional<Contestant>& one) { return one->share; };
    const auto* best = &*std::ranges::max_element(fitted, {}, share);
    arrived_ = best != followed_ && IsExactInFreeRun(**best, null_, levels_, level_);
    followed_ = best;
    return arrived_;
  }
  bool arrived() const { return arrived_; }

 private:
  const Contestant& null_;
  const Levels& levels_;
  std::size_t level_;
  bool follows_ = false, arrived_ = false;
  const std::optional<Contestant>* followed_ = nullptr;
};

}  // namespace

Contestant FitOnce(const estimation::Hypothesis& model, VectorXd from, const Contestant& null, const Levels& levels,
                   std::size_t level, std::size_t count, std::optional<double> next) {
  Contestant contestant(model);
  contestant.levels.resize(levels.size());
  for (Estimate& estimate : contestant.levels) estimate.broken = "not fitted";
  for (std::size_t at = level; at < std::min(level + count, levels.size()); ++at) {
    if (!null.Holds(at)) continue;
    if (at > level && contestant.Holds(level)) {
      if (next && !IsNearTheNoise(null.levels[at]) && std::max(*next, contestant.share) < policy::kLittle) break;
      from = contestant.levels[level].q;
    }
    const estimation::KnownColumns known{&null.hypothesis, &null.levels[at]};
    contestant.levels[at] = AsLoudAs(null, at,
                                     Fit(model, levels[at], from,
                                         {.iterations = 6,
                                          .renewals = at == level ? 4 : 1,  // at the next level it is near already
                                          .points = policy::kLookedAtPoints,
                                          .of_excess = policy::kLookedAt,
                                          .near = true,
                                          .known = known}));
    if (contestant.Holds(at)) contestant.share = std::max(contestant.share, ShareOf(contestant, null, levels, at));
  }
  for (Estimate& estimate : contestant.levels) estimate.DropRows();  // of some dozen candidates a few are fitted again
  return contestant;
}

Looked FirstLook(const Contestant& null, const Levels& levels, std::size_t level, const Magnitudes& magnitudes,
                 const Registry& registry, const Conduct& conduct, const Scope& scope) {
  std::vector<Trial> candidates = TrialsOf(null.hypothesis, levels, magnitudes, registry);
  std::erase_if(candidates, [&](const Trial& candidate) { return !scope.takes(candidate); });
  const Screens screens(null, levels, level);
  const std::vector<Sketch> sketches = SketchesOf(candidates, screens, null, level, conduct);
  Looked looked;
  for (std::size_t i = 0; i < candidates.size(); ++i) {
    if (sketches[i].IsSilent()) looked.silent.push_back(Silence(candidates[i]));
  }
  const std::vector<std::size_t> order = Promising(null, levels, level, sketches, scope.most_fits);
  std::vector<std::optional<Contestant>> seen(order.size());
  // Where the null leaves nothing but noise, so does a candidate only once nominal values have given it back what they had taken on: a
  // fit that begins without that leads it back to nothing.
  const bool swallowed = !HasExcess(null.levels[level], levels.data());
  Follower follower(null, levels, level, scope.until_exact);
  const auto enough = [&](std::size_t begin) {
    return follower.Arrives(std::span(seen).first(begin)) || conduct.spent();
  };
  InParts(order.size(), kSketched, 1.0, conduct, enough, [&](std::size_t i) {
    const Trial& candidate = candidates[order[i]];
    VectorXd from = sketches[order[i]].q;
    if (swallowed) from = screens.here.Followed(candidate, from, screens.here.Of(candidate, from));
    seen[i] =
        FitOnce(candidate.hypothesis, std::move(from), null, levels, level, scope.levels, sketches[order[i]].next);
  });
  for (std::optional<Contestant>& one : seen) {
    if (one && (one->Holds(level) || (scope.levels > 1 && one->Holds(level + 1))))
      looked.ranked.push_back(*std::move(one));
  }
  std::ranges::stable_sort(looked.ranked, std::ranges::greater(), &Contestant::share);
  for (std::size_t i = 0; follower.arrived() && i < seen.size(); ++i) {
    if (!seen[i]) looked.ranked.push_back(NotFitted(candidates[order[i]], sketches[order[i]], levels));
  }
  return looked;
}

}  // namespace dynoproof::diagnosis
