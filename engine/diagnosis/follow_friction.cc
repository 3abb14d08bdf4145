#include "diagnosis/follow_friction.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "diagnosis/candidates.h"
#include "identification/noise_model.h"
#include "score/series.h"

namespace dynoproof::diagnosis {
namespace {

constexpr double kFirst_s = 0.05;        // as long as a line takes to be torn loose a few times ...
constexpr double kFirstSamples = 200.0;  // ... and enough to tell four numbers
constexpr std::size_t kTried = 3;        // places that are fitted fully at a time ...
constexpr std::size_t kLaws = 4;         // ... and starts at each ...
constexpr std::size_t kOfALaw = 2;       // ... of which so many of one law

/// When an output of the first record begins to move [s]: before that nothing can be told.
double MotionBegins(const MappedRecord& record) {
  constexpr double kOverFloor = 6.0, kOfSpread = 0.1;
  double begins_s = record.end_s;
  for (const auto& [name, output] : record.outputs) {
    const Eigen::Map<const Eigen::VectorXd> rows(output.values->data(),
                                                 static_cast<Eigen::Index>(output.values->size()));
    const double enough =
        std::min(kOverFloor * HighFrequencyFloor(rows), kOfSpread * score::StandardDeviation(*output.values));
    for (std::size_t k = 0; k < output.values->size() && (*output.time)[k] < begins_s; ++k) {
      if (std::abs((*output.values)[k] - output.values->front()) > enough) begins_s = (*output.time)[k];
    }
  }
  return begins_s < 0.5 * record.end_s ? begins_s : 0.0;
}

/// Where something rubs, and how hard: for want of a law that of Coulomb, of every size.
std::vector<Hypothesis> Rubbing(const EstimationProblem& first, const std::vector<Place>& places, double torque_Nm) {
  std::vector<EffectInstance> tried;
  for (const Place& place : places) {
    for (double share = 0.02; share < 2.0; share *= 3.0)
      tried.push_back({PlainFriction(first.registry()), place, {share * torque_Nm}});
  }
  std::vector<Hypothesis> best;
  for (Follower& one : FittedBeside(first, first.Nominal(), tried)) {
    const Place& place = one.fit.hypothesis.effects.front().place;
    const bool known = std::any_of(best.begin(), best.end(),
                                   [&](const Hypothesis& other) { return other.effects.front().place == place; });
    if (!known && best.size() < kTried) best.push_back(std::move(one.fit.hypothesis));
  }
  return best;
}

/// The torque at which the body breaks loose.
double BreakAway(const EffectInstance& friction) { return friction.effect->BreakAwayTorque(friction.parameters); }

/// The laws of friction that break away at the torque at which the leader does, at its place: those that explain most.
std::vector<Hypothesis> OtherLaws(const EstimationProblem& here, const Hypothesis& leader, double speed_rad_per_s) {
  const EffectInstance& known = leader.effects.front();
  std::vector<EffectInstance> tried;
  const auto add = [&](const Effect* effect, const Points& points) {
    for (std::vector<double> parameters : points) {
      for (std::size_t i = 0; i < parameters.size(); ++i)
        parameters[i] =
            std::clamp(parameters[i], effect->info().parameters[i].lower, effect->info().parameters[i].upper);
      tried.push_back({effect, known.place, std::move(parameters)});
    }
  };
  for (const Effect* effect : here.registry().Effects())
    if (effect->info().traits.dry_friction) add(effect, effect->StartsFromBreakAway(BreakAway(known), speed_rad_per_s));
  add(known.effect, known.effect->MistakenFor(known.parameters));
  std::vector<Hypothesis> laws;
  std::map<const Effect*, std::size_t> taken;
  for (Follower& one : FittedBeside(here, leader, tried)) {
    if (laws.size() < kLaws && taken[one.fit.hypothesis.effects.front().effect]++ < kOfALaw)
      laws.push_back(std::move(one.fit.hypothesis));
  }
  return laws;
}

}  // namespace

std::optional<Followed> FollowFriction(const EstimationProblem& problem, const std::optional<Place>& place,
                                       const std::function<void(double)>& progress) {
  const Effect* friction = PlainFriction(problem.registry());
  std::vector<Place> places = friction != nullptr ? friction->Places(problem.plan()) : std::vector<Place>();
  if (place) std::erase_if(places, [&](const Place& other) { return !(other == *place); });
  const double end_s = problem.records().front().end_s;
  const double first_s =
      MotionBegins(problem.records().front()) + std::max(kFirst_s, kFirstSamples * problem.channels().front().step_s);
  if (places.empty() || PredictionWindow(problem.plan()) || end_s < 2.0 * first_s) return std::nullopt;
  const Magnitudes seen = MagnitudesOf(problem);
  const EstimationProblem first = problem.Part(first_s / end_s);
  std::vector<Hypothesis> starts;
  for (const Hypothesis& somewhere : Rubbing(first, places, seen.torque)) {
    for (Hypothesis& law : OtherLaws(first, somewhere, seen.speed)) starts.push_back(std::move(law));
  }
  return Follow(
      problem, first_s / end_s, std::move(starts), progress,
      [&](const EstimationProblem& here, const Hypothesis& leader) { return OtherLaws(here, leader, seen.speed); });
}

Hypothesis AsCoulomb(const EstimationProblem& problem, Hypothesis friction) {
  EffectInstance& law = friction.effects.back();
  law = {PlainFriction(problem.registry()), law.place, {BreakAway(law)}};
  return friction;
}

}  // namespace dynoproof::diagnosis
