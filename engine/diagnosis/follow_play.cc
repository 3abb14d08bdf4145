#include "diagnosis/follow_play.h"

#include <algorithm>
#include <utility>

#include "diagnosis/candidates.h"

namespace dynoproof::diagnosis {
namespace {

constexpr double kFirst_s = 0.008;  // two to five periods of a line's first modes: a few impacts
constexpr double kSmallest = 0.01;  // gaps that are tried, in twists under the torques seen ...
constexpr double kLargest = 50.0;   // ... a side in free flight goes far beyond them
constexpr double kGridStep = 1.25;  // fits find the gap from a tenth off

/// Effects that give a shaft of the plan play, and the shafts.
std::vector<std::pair<const Effect*, Place>> PlaysOf(const EstimationProblem& problem) {
  std::vector<std::pair<const Effect*, Place>> plays;
  for (const Effect* effect : problem.registry().Effects()) {
    if (!effect->info().traits.play) continue;
    for (const Place& place : effect->Places(problem.plan())) plays.emplace_back(effect, place);
  }
  return plays;
}

/// Every gap at every shaft, fitted to `first`.
std::vector<Hypothesis> Gaps(const EstimationProblem& first, double torque_Nm) {
  std::vector<Follower> fitted;
  for (const auto& [play, place] : PlaysOf(first)) {
    const Value* stiffness = first.plan().root.FindPath("plant.shaft." + place.name + ".stiffness_Nm_per_rad");
    if (stiffness == nullptr || !stiffness->is_number() || !(stiffness->number() > 0.0)) continue;
    const double twist_rad = torque_Nm / stiffness->number();
    for (double gap = kSmallest; gap < kLargest && !first.spent(); gap *= kGridStep) {
      Hypothesis hypothesis = first.Nominal();
      hypothesis.effects = {{play, place, {gap * twist_rad}}};
      if (std::optional<Follower> one = Fitted(first, hypothesis, 4)) fitted.push_back(*std::move(one));
    }
  }
  BestFirst(fitted);
  std::vector<Hypothesis> gaps;
  for (Follower& one : fitted) gaps.push_back(std::move(one.fit.hypothesis));
  return gaps;
}

}  // namespace

double FirstShare(const std::vector<MappedRecord>& records) {
  return kFirst_s / std::max(records.front().end_s, kFirst_s);
}

std::optional<Followed> FollowPlay(const EstimationProblem& problem, const std::function<void(double)>& progress) {
  if (PlaysOf(problem).empty() || PredictionWindow(problem.plan())) return std::nullopt;
  const double first = FirstShare(problem.records());
  return Follow(problem, first, Gaps(problem.Part(first), MagnitudesOf(problem).torque), progress);
}

}  // namespace dynoproof::diagnosis
