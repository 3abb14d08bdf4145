#include "diagnosis/follow.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "diagnosis/noise.h"
#include "diagnosis/parallel.h"

namespace dynoproof::diagnosis {
namespace {

constexpr double kStride = 1.25;       // from one part to the next
constexpr std::size_t kFollowed = 32;  // hypotheses that go on
constexpr double kAtFloor = 2.0;       // times the noise of the highest frequencies, which 80 samples tell to a third
constexpr double kAlone = 200.0;       // -2 log likelihood ahead of all others: alone from there on
// With relatives:
constexpr double kStruggles = 1.3;   // times the noise: they are asked
constexpr double kLost = 6.0;        // times the noise: a slip that comes a little late is over soon, all this is not
constexpr double kOffTheLine = 8.0;  // spreads of a nominal value: it is the doubts that explain the records

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

bool Twins(const Follower& a, const Follower& b) {
  const std::vector<Assumed>&one = a.fit.hypothesis.effects, &other = b.fit.hypothesis.effects;
  return std::equal(one.begin(), one.end(), other.begin(), other.end(), [](const Assumed& x, const Assumed& y) {
    return x.effect == y.effect && x.place == y.place &&
           std::equal(x.parameters.begin(), x.parameters.end(), y.parameters.begin(),
                      [](double p, double q) { return p == q || std::abs(p / q - 1.0) < 2e-3; });
  });
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

void BestFirst(std::vector<Follower>& followers) {
  std::stable_sort(followers.begin(), followers.end(),
                   [](const Follower& a, const Follower& b) { return a.likelihood < b.likelihood; });
}

std::optional<Follower> Fitted(const Study& here, const Hypothesis& hypothesis, int rounds) {
  Fit fit = FitAt(here, hypothesis);
  if (!fit.ok()) return std::nullopt;
  const Whitener whitener = WhitenerOf(here, fit, 0);
  fit = Fitter(here, whitener).Polish(std::move(fit), rounds);
  if (!fit.ok()) return std::nullopt;
  return Weighed(here, std::move(fit));
}

std::vector<Follower> FittedBeside(const Study& here, const Hypothesis& about, const std::vector<Assumed>& effects) {
  const Result<DoubtModel> doubts = LineariseDoubts(here, about, FreedomOf(here, about.effects));
  if (!doubts.ok()) return {};
  const Fitter fitter(here, Whitener(here.channels(), here.measured() - doubts->predicted, 0));
  std::vector<std::optional<Follower>> fitted(effects.size());
  ParallelFor(effects.size(), 0, [&](std::size_t k) {
    Fit fit = fitter.Optimise({effects[k]}, *doubts, 8);
    if (!fit.ok()) return;
    fitted[k] = Weighed(here, std::move(fit));
    fitted[k]->fit.hypothesis.z = about.z;  // the doubts' shift is linear, and another one beside the effect
  });
  std::vector<Follower> followers;
  for (std::optional<Follower>& one : fitted) {
    if (one) followers.push_back(*std::move(one));
  }
  BestFirst(followers);
  return followers;
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
    starts.clear();
    for (Follower& one : followers) starts.push_back(std::move(one.fit.hypothesis));
    found = Followed{starts.front(), {starts.begin() + 1, starts.end()}, share};
    if (share == 1.0) break;
  }
  if (!found || found->share < 2.0 * first || over > kAtFloor) return std::nullopt;
  if (found->share < 1.0 && !Forgets(study, found->hypothesis)) return std::nullopt;
  return found;
}

}  // namespace dynoproof::diagnosis
