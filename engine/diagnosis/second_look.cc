#include "diagnosis/second_look.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>
#include <utility>

#include "diagnosis/carry.h"
#include "diagnosis/first_look.h"
#include "diagnosis/policy.h"

namespace dynoproof::diagnosis {
namespace {

/// The contestants that remove a share of the null's excess at a level, those that remove most first.
std::vector<std::size_t> Removing(const Contest& contest, const Levels& levels, std::size_t level) {
  std::vector<std::pair<double, std::size_t>> shares;
  for (std::size_t i = 1; i < contest.contestants.size(); ++i) {
    const Contestant& one = contest.contestants[i];
    if (!one.Holds(level) || one.levels[level].jacobian.size() == 0) continue;
    const double share = ShareOf(one, contest.null(), levels, level);
    if (share >= policy::kShare) shares.emplace_back(-share, i);
  }
  std::ranges::sort(shares);
  std::vector<std::size_t> which;
  for (const auto& [share, i] : shares) which.push_back(i);
  which.resize(std::min(which.size(), policy::kBases));
  return which;
}

/// Whether what a model leaves at its longest memory may be another cause beside a noise that can be seen.
bool NearEnough(const Contestant& one) {
  for (std::size_t level = one.levels.size(); level-- > 0;) {
    if (!one.Holds(level)) continue;
    return std::ranges::all_of(one.levels[level].scales, [](const estimation::ChannelScale& scale) {
      return scale.rms <= policy::kNearEnough * scale.noise_alone;
    });
  }
  return false;
}

/// The half of the first pair that most of these pairs share: a search on top of it meets them all. Where they share neither, that on
/// top of which the pair was found.
std::size_t SharedHalf(const Contest& contest, std::span<const Base> pairs) {
  const auto count = [&](std::size_t contestant) {
    const estimation::Hypothesis::Applied& half = contest.contestants[contestant].hypothesis.effects().back();
    return std::ranges::count_if(
        pairs, [&](const Base& base) { return std::ranges::count(base.pair.hypothesis.effects(), half) > 0; });
  };
  const auto& best = pairs.front().pair.hypothesis.effects();
  std::size_t chosen = pairs.front().contestant;
  for (std::size_t i = 1; i < contest.contestants.size(); ++i) {
    if (std::ranges::count(best, contest.contestants[i].hypothesis.effects().back()) > 0 && count(i) > count(chosen))
      chosen = i;
  }
  return chosen;
}

/// How many pairs their level does not tell apart from the one that leaves least there.
std::size_t CountAlike(std::span<const Base> pairs, const Levels& levels) {
  double least = std::numeric_limits<double>::infinity();
  for (const Base& base : pairs) least = std::min(least, LogLeft(base.fit(), levels));
  const auto alike = [&](const Base& base) {
    return LogLeft(base.fit(), levels) - least <= std::log(policy::kMarginBest);
  };
  return static_cast<std::size_t>(std::ranges::count_if(pairs, alike));
}

/// Carries pairs to the free run, and orders them by what they leave there.
void OrderInFreeRun(std::span<Base> pairs, const Contest& contest, const Levels& levels, const Conduct& conduct) {
  std::vector<Contestant> carried = {contest.null()};
  for (const Base& base : pairs) carried.push_back(base.pair);
  if (!Carry(carried, levels, pairs.front().level, conduct)) return;
  const std::size_t level = levels.free_run();
  std::vector<std::pair<double, Base>> ordered;
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    const Contestant& pair = carried[i + 1];
    ordered.emplace_back(
        pair.Holds(level) ? LogLeft(pair.levels[level], levels) : std::numeric_limits<double>::infinity(),
        std::move(pairs[i]));
  }
  std::ranges::stable_sort(ordered, {}, &std::pair<double, Base>::first);
  for (std::size_t i = 0; i < pairs.size(); ++i) pairs[i] = std::move(ordered[i].second);
}

}  // namespace

std::vector<Base> BasesOfPairs(const Contest& contest, const Levels& levels, const Magnitudes& magnitudes,
                               const Registry& registry, const Conduct& conduct) {
  const std::size_t level = levels.longest();
  std::vector<Base> bases;
  if (!contest.null().Holds(level)) return bases;
  const auto shown = [&](const Trial& candidate) {
    const auto same = [&](const Contestant& one) {
      return one.share >= policy::kLittle && one.hypothesis.effects().back() == candidate.hypothesis.effects().back();
    };
    return std::any_of(contest.contestants.begin() + 1, contest.contestants.end(), same) ||
           std::ranges::any_of(contest.left_behind, same);
  };
  for (const std::size_t i : Removing(contest, levels, level)) {
    if (conduct.spent()) break;
    const Looked looked = FirstLook(contest.contestants[i], levels, level, magnitudes, registry, conduct,
                                    {.takes = shown, .most_fits = policy::kLookedAtLeast, .levels = 1});
    const Contestant* best = LeaderAt(looked.ranked, levels, level);
    if (best != nullptr) bases.push_back({i, *best, level});
  }
  std::ranges::stable_sort(bases, {}, [&](const Base& base) { return LogLeft(base.fit(), levels); });
  if (bases.empty() || !IsNearTheNoise(bases.front().fit()) || level == levels.free_run()) return bases;
  if (const std::size_t alike = CountAlike(bases, levels); alike > 1)
    OrderInFreeRun(std::span(bases).first(alike), contest, levels, conduct);
  return bases;
}

std::optional<std::size_t> BaseOf(const Contest& contest, const Settled& settled, const std::vector<Base>& bases,
                                  const Levels& levels, Journal& journal) {
  const bool most = settled.best && settled.best_explains >= policy::kHeldOutReleased;
  std::optional<std::size_t> leader = !settled.causes.empty() ? std::optional(settled.causes.front())
                                      : most                  ? settled.best
                                                              : std::nullopt;
  const auto of_leader =
      std::ranges::find_if(bases, [&](const Base& base) { return leader && base.contestant == *leader; });
  const bool near = of_leader != bases.end() && IsNearTheNoise(of_leader->fit());
  if (leader && !contest.released && !near && !NearEnough(contest.contestants[*leader])) leader.reset();
  if (bases.empty()) return leader;
  const Base& best = bases.front();
  const bool less = of_leader == bases.end() ||
                    LogLeft(of_leader->fit(), levels) - LogLeft(best.fit(), levels) > std::log(policy::kMarginBest);
  const bool takes = less && (leader ? of_leader != bases.end() : IsNearTheNoise(best.fit()));
  const std::size_t half = SharedHalf(contest, std::span(bases).first(CountAlike(bases, levels)));
  JournalEntry entry{"second look",
                     {best.pair.Name()},
                     "excess of the best pair on top of each, " + levels.Name(best.level),
                     {},
                     takes    ? "goes on from " + contest.contestants[half].Name()
                     : leader ? "goes on from " + contest.contestants[*leader].Name()
                              : "none is near the noise"};
  for (const Base& base : bases)
    entry.numbers.emplace_back(base.pair.Name(), std::exp(0.5 * LogLeft(base.fit(), levels)));
  journal.push_back(std::move(entry));
  return takes ? half : leader;
}

}  // namespace dynoproof::diagnosis
