#include "diagnosis/follow.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include "diagnosis/candidates.h"
#include "diagnosis/fit.h"
#include "diagnosis/noise.h"
#include "diagnosis/parallel.h"
#include "score/series.h"

namespace dynoproof::diagnosis {
namespace {

constexpr double kFirst_s = 0.008;       // two to five periods of a line's first modes: a few impacts
constexpr double kStride = 1.25;         // from one part to the next
constexpr double kSmallest = 0.01;       // gaps that are tried, in twists under the torques seen ...
constexpr double kLargest = 50.0;        // ... a side in free flight goes far beyond them
constexpr double kGridStep = 1.25;       // fits find the gap from a tenth off
constexpr std::size_t kFollowed = 32;    // hypotheses that go on
constexpr double kAtFloor = 2.0;         // times the noise of the highest frequencies, which 80 samples tell to a third
constexpr double kAlone = 200.0;         // -2 log likelihood ahead of all others: alone from there on
constexpr double kLost = 6.0;            // of friction: a slip that comes a little late is over soon
constexpr double kOffTheLine = 8.0;      // spreads of a nominal value: it is the doubts that explain the records
constexpr double kStruggles = 1.3;       // times that noise: the leader's relatives are asked
constexpr double kFirstSlips_s = 0.05;   // as long as a line takes to be torn loose a few times ...
constexpr double kFirstSamples = 200.0;  // ... and enough to tell four numbers
constexpr std::size_t kFrictions = 3;    // laws of friction that are fitted anew at a time

struct Follower {
  Fit fit;
  double likelihood = 0.0;  // -2 log, at the noise that fits best by channel, with the doubts' prior
  double over = 0.0;        // RMS of what is left over the noise floor, of the worst channel
};

Follower Weighed(const Study& study, Fit fit) {
  Follower follower{std::move(fit)};
  const Eigen::VectorXd left = study.measured() - follower.fit.predicted;
  follower.likelihood = PriorChi2(follower.fit);
  for (const Channel& c : study.channels()) {
    const auto rows = left.segment(c.begin, c.count);
    const double rms = std::max(RmsOf(rows), 1e-12 * c.nominal);
    follower.likelihood += 2.0 * static_cast<double>(c.count) * std::log(rms);
    follower.over = std::max(follower.over, rms / std::max(HighFrequencyFloor(rows), 1e-300));
  }
  return follower;
}

void BestFirst(std::vector<Follower>& followers) {
  std::stable_sort(followers.begin(), followers.end(),
                   [](const Follower& a, const Follower& b) { return a.likelihood < b.likelihood; });
}

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

/// As if the noise were white: on parts this short its colour cannot be told.
std::optional<Follower> Fitted(const Study& study, const Hypothesis& hypothesis, int rounds) {
  Fit fit = FitAt(study, hypothesis);
  if (!fit.ok()) return std::nullopt;
  const Whitener whitener = WhitenerOf(study, fit, 0);
  fit = Fitter(study, whitener).Polish(std::move(fit), rounds);
  if (!fit.ok()) return std::nullopt;
  return Weighed(study, std::move(fit));
}

bool Twins(const Follower& a, const Follower& b) {
  const std::vector<Assumed>&one = a.fit.hypothesis.effects, &other = b.fit.hypothesis.effects;
  return std::equal(one.begin(), one.end(), other.begin(), other.end(), [](const Assumed& x, const Assumed& y) {
    return x.effect == y.effect && x.place == y.place &&
           std::equal(x.parameters.begin(), x.parameters.end(), y.parameters.begin(),
                      [](double p, double q) { return p == q || std::abs(p / q - 1.0) < 2e-3; });
  });
}

/// Every gap at every shaft, fitted to `first`.
std::vector<Hypothesis> Gaps(const Study& first, const Effect& play, double torque_Nm) {
  std::vector<Follower> fitted;
  for (const Place& place : play.Places(first.plan())) {
    const Value* stiffness = first.plan().root.FindPath("plant.shaft." + place.name + ".stiffness_Nm_per_rad");
    if (stiffness == nullptr || !stiffness->is_number() || !(stiffness->number() > 0.0)) continue;
    const double twist_rad = torque_Nm / stiffness->number();
    for (double gap = kSmallest; gap < kLargest; gap *= kGridStep) {
      Hypothesis hypothesis = first.Nominal();
      hypothesis.effects = {{&play, place, {gap * twist_rad}}};
      if (std::optional<Follower> one = Fitted(first, hypothesis, 4)) fitted.push_back(*std::move(one));
    }
  }
  BestFirst(fitted);
  std::vector<Hypothesis> gaps;
  for (Follower& one : fitted) gaps.push_back(std::move(one.fit.hypothesis));
  return gaps;
}

/// Who goes on: one of each gap, and no more than can be paid for. With `relatives` that are asked where the leader
/// comes short, nobody else has to be kept for it.
void Thin(std::vector<Follower>& followers, bool relatives) {
  std::vector<Follower> kept;
  for (Follower& one : followers) {
    if (kept.size() == kFollowed) break;
    if (relatives && !kept.empty() && one.likelihood > kept.front().likelihood + kAlone) break;
    if (std::none_of(kept.begin(), kept.end(), [&](const Follower& other) { return Twins(one, other); }))
      kept.push_back(std::move(one));
  }
  if (kept.size() > 1 && kept[0].over < kAtFloor && kept[1].likelihood - kept[0].likelihood > kAlone) kept.resize(1);
  followers = std::move(kept);
}

/// Effects fitted to `here` beside the doubts as `about` has them, best first.
std::vector<Follower> FittedBeside(const Study& here, const Hypothesis& about, const std::vector<Assumed>& effects) {
  const Result<DoubtModel> doubts = LineariseDoubts(here, about, FreedomOf(here, about.effects));
  if (!doubts.ok()) return {};
  const Fitter fitter(here, Whitener(here.channels(), here.measured() - doubts->predicted, 0));
  std::vector<std::optional<Follower>> fitted(effects.size());
  ParallelFor(effects.size(), 0, [&](std::size_t k) {
    Fit fit = fitter.Optimise({effects[k]}, *doubts, 8);
    if (fit.ok()) fitted[k] = Weighed(here, std::move(fit));
  });
  std::vector<Follower> followers;
  for (std::optional<Follower>& one : fitted) {
    if (one) followers.push_back(*std::move(one));
  }
  BestFirst(followers);
  return followers;
}

/// Where something rubs, and how hard: for want of a law that of Coulomb, of every size.
std::vector<Hypothesis> Rubbing(const Study& first, const std::vector<Place>& places, double torque_Nm) {
  std::vector<Assumed> tried;
  for (const Place& place : places) {
    for (double share = 0.02; share < 2.0; share *= 3.0)
      tried.push_back({first.registry().FindEffect("coulomb_friction"), place, {share * torque_Nm}});
  }
  std::vector<Hypothesis> best;
  for (Follower& one : FittedBeside(first, first.Nominal(), tried)) {
    const Place& place = one.fit.hypothesis.effects.front().place;
    const bool known = std::any_of(best.begin(), best.end(),
                                   [&](const Hypothesis& other) { return other.effects.front().place == place; });
    if (!known && best.size() < kFrictions) best.push_back(std::move(one.fit.hypothesis));
  }
  return best;
}

/// The laws of friction that break away at the torque at which the leader does, at its place: those that explain most.
std::vector<Hypothesis> OtherLaws(const Study& here, const Hypothesis& leader, double speed_rad_per_s) {
  const Assumed& known = leader.effects.front();
  // Of Stribeck's numbers the second is at rest; of the others the first.
  const double torque = known.parameters[known.effect->info().name == "stribeck_friction" ? 1 : 0];
  std::vector<Assumed> tried;
  const auto add = [&](const char* name, std::vector<double> parameters) {
    const Effect* effect = here.registry().FindEffect(name);
    for (std::size_t i = 0; i < parameters.size(); ++i)
      parameters[i] = std::clamp(parameters[i], effect->info().parameters[i].lower, effect->info().parameters[i].upper);
    tried.push_back({effect, known.place, std::move(parameters)});
  };
  // In a resonance inertias go much faster than what is measured, and break away far below that.
  for (const double share : {0.01, 0.05, 0.2, 1.0, 5.0}) {
    const double speed = share * speed_rad_per_s;
    add("stribeck_friction", {0.6 * torque, torque, speed});
    add("asymmetric_friction", {torque, torque, 0.1 * torque / speed, 0.1 * torque / speed});
    add("dahl_friction", {torque, 3000.0 * torque / speed});
  }
  std::vector<Hypothesis> laws;
  for (Follower& one : FittedBeside(here, leader, tried)) {
    if (laws.size() < kFrictions) laws.push_back(std::move(one.fit.hypothesis));
  }
  return laws;
}

/// Whether what the hypothesis misses of the whole records is what another step of the solver changes as well.
bool Forgets(const Study& study, const Hypothesis& hypothesis) {
  const Result<Eigen::VectorXd> coarse = study.Predict(hypothesis), fine = study.PredictFiner(hypothesis);
  if (!coarse.ok() || !fine.ok()) return false;
  constexpr double kComparable = 0.3;
  const Eigen::VectorXd left = study.measured() - *coarse, moved = *fine - *coarse;
  return std::all_of(study.channels().begin(), study.channels().end(), [&](const Channel& c) {
    const auto rows = left.segment(c.begin, c.count);
    const double missed = RmsOf(rows);
    return missed < kAtFloor * HighFrequencyFloor(rows) ||
           RmsOf(moved.segment(c.begin, c.count)) > kComparable * missed;
  });
}

}  // namespace

double FirstShare(const std::vector<MappedRecord>& records) {
  return kFirst_s / std::max(records.front().end_s, kFirst_s);
}

std::optional<Followed> Follow(const Study& study, double first, std::vector<Hypothesis> starts,
                               const std::function<void(double)>& progress, const Relatives& relatives) {
  std::optional<Followed> found;
  double over = std::numeric_limits<double>::infinity();  // of the leader
  for (double share = first; !starts.empty(); share = std::min(1.0, kStride * share)) {
    progress(std::log(share / first) / std::log(1.0 / first));
    const Study here = study.Part(share);
    std::vector<Follower> followers;
    const auto fit = [&](const std::vector<Hypothesis>& from, int rounds) {
      for (const Hypothesis& start : from) {
        if (std::optional<Follower> on = Fitted(here, start, rounds)) followers.push_back(*std::move(on));
      }
      BestFirst(followers);
    };
    fit(starts, 5);
    if (relatives && !followers.empty() && followers.front().over > std::max(over, kStruggles)) {
      const Hypothesis leader = followers.front().fit.hypothesis;
      fit({leader}, 12);
      fit(relatives(here, leader), 12);
    }
    Thin(followers, static_cast<bool>(relatives));
    if (followers.empty() || followers.front().over > (relatives ? kLost : kAtFloor)) break;
    if (relatives && Farthest(here, followers.front().fit) > kOffTheLine) break;
    over = followers.front().over;
    found = Followed{followers.front().fit.hypothesis, share};
    if (share == 1.0) break;
    starts.clear();
    for (Follower& one : followers) starts.push_back(std::move(one.fit.hypothesis));
  }
  if (!found || found->share < 2.0 * first || over > kAtFloor) return std::nullopt;
  if (found->share < 1.0 && !Forgets(study, found->hypothesis)) return std::nullopt;
  return found;
}

std::optional<Followed> FollowPlay(const Study& study, const std::function<void(double)>& progress) {
  const Effect* play = study.registry().FindEffect("backlash");
  if (play == nullptr || play->Places(study.plan()).empty() || PredictionWindow(study.plan())) return std::nullopt;
  const double first = FirstShare(study.records());
  return Follow(study, first, Gaps(study.Part(first), *play, MagnitudesOf(study).torque), progress);
}

std::optional<Followed> FollowFriction(const Study& study, const std::optional<Place>& place,
                                       const std::function<void(double)>& progress) {
  const Effect* friction = study.registry().FindEffect("coulomb_friction");
  std::vector<Place> places = friction != nullptr ? friction->Places(study.plan()) : std::vector<Place>();
  if (place) std::erase_if(places, [&](const Place& other) { return !(other == *place); });
  const double end_s = study.records().front().end_s;
  const double first_s =
      MotionBegins(study.records().front()) + std::max(kFirstSlips_s, kFirstSamples * study.channels().front().step_s);
  if (places.empty() || PredictionWindow(study.plan()) || end_s < 2.0 * first_s) return std::nullopt;
  const Magnitudes seen = MagnitudesOf(study);
  const Study first = study.Part(first_s / end_s);
  std::vector<Hypothesis> starts;
  for (const Hypothesis& somewhere : Rubbing(first, places, seen.torque)) {
    for (Hypothesis& law : OtherLaws(first, somewhere, seen.speed)) starts.push_back(std::move(law));
  }
  return Follow(study, first_s / end_s, std::move(starts), progress,
                [&](const Study& here, const Hypothesis& leader) { return OtherLaws(here, leader, seen.speed); });
}

bool IsDryFriction(const Effect& effect) {
  const std::string& name = effect.info().name;
  return name == "coulomb_friction" || name == "dahl_friction" || FallsOrDiffers(effect);
}

bool FallsOrDiffers(const Effect& friction) {
  return friction.info().name == "stribeck_friction" || friction.info().name == "asymmetric_friction";
}

}  // namespace dynoproof::diagnosis
