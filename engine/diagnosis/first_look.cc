#include "diagnosis/first_look.h"

#include <algorithm>
#include <atomic>
#include <optional>

#include "base/parallel.h"
#include "diagnosis/policy.h"
#include "diagnosis/sketch.h"

namespace dynoproof::diagnosis {
namespace {

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

/// Where a model that was fitted at a level begins at another one: at the null's values there, moved by as much as it has moved them. What the
/// null itself moves between the two levels is known, and a model that has found nothing begins where the null is.
VectorXd MovedAlong(const Contestant& one, const Contestant& null, std::size_t level, std::size_t to) {
  VectorXd from = one.levels[level].q;
  const VectorXd before = StartFrom(one.hypothesis, null.hypothesis, null.levels[level].q, from),
                 there = StartFrom(one.hypothesis, null.hypothesis, null.levels[to].q, from);
  return from + there - before;
}

}  // namespace

Contestant FitOnce(const estimation::Hypothesis& model, VectorXd from, const Contestant& null, const Levels& levels,
                   std::size_t level, std::size_t count) {
  Contestant contestant(model);
  contestant.levels.resize(levels.size());
  for (Estimate& estimate : contestant.levels) estimate.broken = "not fitted";
  for (std::size_t at = level; at < std::min(level + count, levels.size()); ++at) {
    if (!null.Holds(at)) continue;
    if (at > level && contestant.Holds(level)) from = MovedAlong(contestant, null, level, at);
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
  constexpr std::size_t kAtOnce = 16;  // between two questions whether to go on
  constexpr double kSketched = 0.6;    // of the work
  std::vector<Trial> candidates = TrialsOf(null.hypothesis, levels, magnitudes, registry);
  std::erase_if(candidates, [&](const Trial& candidate) { return !scope.takes(candidate); });
  const Screens screens(null, levels, level);
  std::atomic<std::size_t> done = 0;
  const auto in_parts = [&](std::size_t count, double from, double to, const auto& work) {
    done = 0;
    for (std::size_t begin = 0; begin < count && !conduct.spent(); begin += kAtOnce) {
      ParallelFor(std::min(kAtOnce, count - begin), 0, [&](std::size_t i) {
        work(begin + i);
        conduct.progress(from + (to - from) * static_cast<double>(++done) / static_cast<double>(count));
      });
    }
  };
  std::vector<Sketch> sketches(candidates.size());
  in_parts(candidates.size(), 0.0, kSketched, [&](std::size_t i) {
    const VectorXd from = StartFrom(candidates[i].hypothesis, null.hypothesis, null.levels[level].q);
    const std::string name = candidates[i].hypothesis.Name() + ", first look";
    if (const std::optional<VectorXd> known = conduct.Recall(name, level, from.size() + 2))
      sketches[i] = {known->head(from.size()), known->tail(2)[0], known->tail(1)[0]};
    else
      sketches[i] = SketchOf(candidates[i], screens, from);
    VectorXd kept(from.size() + 2);
    kept << sketches[i].q, sketches[i].removes, sketches[i].moves.value_or(policy::kUnseen);
    conduct.Keep(name, level, kept);
  });
  Looked looked;
  std::vector<std::size_t> order;
  for (std::size_t i = 0; i < candidates.size(); ++i) {
    if (sketches[i].removes >= 0.0) order.push_back(i);
    if (sketches[i].IsSilent()) looked.silent.push_back(Silence(candidates[i]));
  }
  std::ranges::stable_sort(order,
                           [&](std::size_t a, std::size_t b) { return sketches[a].removes > sketches[b].removes; });
  order.resize(std::min(order.size(), WorthFitting(null, levels, level, order, sketches, scope.most_fits)));
  std::vector<std::optional<Contestant>> seen(order.size());
  // Where the null leaves nothing but noise, so does a candidate only once nominal values have given it back what they had taken on: a
  // fit that begins without that leads it back to nothing.
  const bool swallowed = !HasExcess(null.levels[level], levels.data());
  in_parts(order.size(), kSketched, 1.0, [&](std::size_t i) {
    const Trial& candidate = candidates[order[i]];
    VectorXd from = sketches[order[i]].q;
    if (swallowed) from = screens.here.Followed(candidate, from, screens.here.Of(candidate, from));
    seen[i] = FitOnce(candidate.hypothesis, std::move(from), null, levels, level, scope.levels);
  });
  for (std::optional<Contestant>& one : seen) {
    if (one && (one->Holds(level) || (scope.levels > 1 && one->Holds(level + 1))))
      looked.ranked.push_back(*std::move(one));
  }
  std::ranges::stable_sort(looked.ranked, [](const Contestant& a, const Contestant& b) { return a.share > b.share; });
  return looked;
}

}  // namespace dynoproof::diagnosis
