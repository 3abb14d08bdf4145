#include "diagnosis/follow.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "diagnosis/candidates.h"
#include "diagnosis/fit.h"
#include "diagnosis/noise.h"

namespace dynoproof::diagnosis {
namespace {

constexpr double kFirst_s = 0.008;     // two to five periods of a line's first modes: a few impacts
constexpr double kStride = 1.25;       // from one part to the next
constexpr double kSmallest = 0.01;     // gaps that are tried, in twists under the torques seen ...
constexpr double kLargest = 50.0;      // ... a side in free flight goes far beyond them
constexpr double kGridStep = 1.25;     // fits find the gap from a tenth off
constexpr std::size_t kFollowed = 32;  // hypotheses that go on
constexpr double kAtFloor = 2.0;       // times the noise of the highest frequencies, which 80 samples tell to a third
constexpr double kAlone = 200.0;       // -2 log likelihood ahead of all others: alone from there on

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

/// Who goes on: one of each gap, and no more than can be paid for.
void Thin(std::vector<Follower>& followers) {
  std::vector<Follower> kept;
  for (Follower& one : followers) {
    if (kept.size() == kFollowed) break;
    if (std::none_of(kept.begin(), kept.end(), [&](const Follower& other) { return Twins(one, other); }))
      kept.push_back(std::move(one));
  }
  if (kept.size() > 1 && kept[0].over < kAtFloor && kept[1].likelihood - kept[0].likelihood > kAlone) kept.resize(1);
  followers = std::move(kept);
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
                               const std::function<void(double)>& progress) {
  std::optional<Followed> found;
  for (double share = first; !starts.empty(); share = std::min(1.0, kStride * share)) {
    progress(std::log(share / first) / std::log(1.0 / first));
    const Study here = study.Part(share);
    std::vector<Follower> followers;
    for (const Hypothesis& start : starts) {
      if (std::optional<Follower> on = Fitted(here, start, 5)) followers.push_back(*std::move(on));
    }
    BestFirst(followers);
    Thin(followers);
    if (followers.empty() || followers.front().over > kAtFloor) break;
    found = Followed{followers.front().fit.hypothesis, share};
    if (share == 1.0) break;
    starts.clear();
    for (Follower& one : followers) starts.push_back(std::move(one.fit.hypothesis));
  }
  if (!found || found->share < 2.0 * first) return std::nullopt;
  if (found->share < 1.0 && !Forgets(study, found->hypothesis)) return std::nullopt;
  return found;
}

std::optional<Followed> FollowPlay(const Study& study, const std::function<void(double)>& progress) {
  const Effect* play = study.registry().FindEffect("backlash");
  if (play == nullptr || play->Places(study.plan()).empty() || PredictionWindow(study.plan())) return std::nullopt;
  const double first = FirstShare(study.records());
  return Follow(study, first, Gaps(study.Part(first), *play, MagnitudesOf(study).torque), progress);
}

}  // namespace dynoproof::diagnosis
