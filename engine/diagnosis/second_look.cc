#include "diagnosis/second_look.h"

#include <algorithm>

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
  std::ranges::stable_sort(bases, {}, [&](const Base& base) { return LogExcess(base.fit().scales, levels.data()); });
  return bases;
}

}  // namespace dynoproof::diagnosis
