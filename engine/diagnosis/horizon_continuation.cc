#include "diagnosis/horizon_continuation.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "base/parallel.h"
#include "identification/noise_model.h"

namespace dynoproof::diagnosis {
namespace {

constexpr double kStride = 1.25;       // from one part to the next ...
constexpr double kShortest = 1.02;     // ... and where need be ...
constexpr double kRecovers = 1.5;      // ... from which it grows again
constexpr std::size_t kFollowed = 32;  // hypotheses that go on
constexpr double kAtFloor = 2.0;       // times the noise of the highest frequencies, which 80 samples tell to a third
constexpr double kAlone = 200.0;       // -2 log likelihood ahead of all others: alone from there on
constexpr double kStruggles = 1.3;     // times the noise: the leader gets more time, and its relatives are asked
// With relatives:
constexpr double kLost = 6.0;  // times the noise: a slip that comes a little late is over soon, all this is not
constexpr double kOffTheLine =
    8.0;  // spreads of a nominal value: it is the nuisance parameters that explain the records

Follower Weighed(const EstimationProblem& problem, Estimate fit) {
  Follower follower{std::move(fit)};
  const Eigen::VectorXd left = problem.measured() - follower.fit.predicted;
  follower.likelihood = PriorChi2(follower.fit);
  for (const Channel& c : problem.channels()) {
    const auto rows = left.segment(c.begin, c.count);
    const double rms = std::max(RmsOf(rows), 1e-12 * c.nominal);
    follower.likelihood += 2.0 * static_cast<double>(c.count) * std::log(rms);
    follower.over = std::max(follower.over, rms / std::max(HighFrequencyFloor(rows), 1e-300));
  }
  return follower;
}

bool Twins(const Follower& a, const Follower& b) {
  const std::vector<EffectInstance>&one = a.fit.hypothesis.effects, &other = b.fit.hypothesis.effects;
  return std::equal(
      one.begin(), one.end(), other.begin(), other.end(), [](const EffectInstance& x, const EffectInstance& y) {
        return x.SameCause(y) && std::equal(x.parameters.begin(), x.parameters.end(), y.parameters.begin(),
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

/// Whether what the hypothesis misses of the whole records is what another step of the solver changes as well, or the
/// machine's nominal values, of which a short beginning tells little: what moves slowly is not chaotic. All nominal
/// values move up together, which leaves undamped frequencies where they are: it refuses rather too often.
bool Forgets(const EstimationProblem& problem, const Hypothesis& hypothesis) {
  Hypothesis shifted = hypothesis;
  const std::vector<double> freedom = FreedomOf(problem, hypothesis.effects);
  for (std::size_t i = 0; i < freedom.size(); ++i) {
    if (!problem.nuisances()[i].start) shifted.z[i] += freedom[i];
  }
  const Result<Eigen::VectorXd> coarse = problem.Predict(hypothesis), fine = problem.PredictFiner(hypothesis),
                                beside = problem.Predict(shifted);
  if (!coarse.ok() || !fine.ok() || !beside.ok()) return false;
  constexpr double kComparable = 0.3, kSlow = 0.1;
  const Eigen::VectorXd left = problem.measured() - *coarse, moved = *fine - *coarse, nuisance = *beside - *coarse;
  bool chaotic = false;
  const bool told = std::all_of(problem.channels().begin(), problem.channels().end(), [&](const Channel& c) {
    const auto rows = left.segment(c.begin, c.count);
    const double missed = RmsOf(rows), by_nuisances = RmsOf(nuisance.segment(c.begin, c.count));
    const bool by_step = RmsOf(moved.segment(c.begin, c.count)) > kComparable * missed;
    chaotic = chaotic || by_step;
    return by_step || missed < kAtFloor * HighFrequencyFloor(rows) ||
           (missed < by_nuisances && by_nuisances < kSlow * c.spread);
  });
  return told && chaotic;
}

/// At its place on the part that it was followed through, with its covariance.
Estimate Settled(const EstimationProblem& problem, const Followed& way) {
  const EstimationProblem here = problem.Part(way.share);
  Estimate fit = Converged(here, EstimateAt(here, way.hypothesis));
  if (!fit.ok()) return fit;
  if (fit.nuisances.jacobian.cols() != static_cast<Eigen::Index>(fit.nuisances.free.size()))
    fit.broken = "no run beside it";
  else
    Estimator(here, WhitenerOf(here, fit)).Derive(fit);
  return fit;
}

bool SameCause(const Hypothesis& a, const Hypothesis& b) {
  return std::equal(a.effects.begin(), a.effects.end(), b.effects.begin(), b.effects.end(),
                    [](const EffectInstance& x, const EffectInstance& y) { return x.SameCause(y); });
}

/// Whether what `longer` says of the effects lies within what `shorter` has left open.
bool Sharpens(const Estimate& longer, const Estimate& shorter) {
  constexpr double kSpreads = 3.0;
  if (!SameCause(longer.hypothesis, shorter.hypothesis)) return false;
  const std::vector<EffectInstance>&one = longer.hypothesis.effects, &other = shorter.hypothesis.effects;
  Eigen::Index k = 0;
  for (std::size_t e = 0; e < other.size(); ++e) {
    for (std::size_t i = 0; i < other[e].parameters.size(); ++i, ++k) {
      const double open = kSpreads * shorter.StandardDeviation(k);
      if (std::abs(one[e].parameters[i] - other[e].parameters[i]) > open) return false;
    }
  }
  return true;
}

/// Of the last of `ways`, see Followed. Parts shorter than `from` tell too little, but for the last one before it.
std::vector<double> DriftOf(const std::vector<Followed>& ways, double from) {
  const std::vector<double>& last = ways.back().hypothesis.effects.front().parameters;
  std::vector<double> drift(last.size(), 0.0);
  bool counted = false;
  for (std::size_t k = ways.size() - 1; k-- > 0;) {
    if (!SameCause(ways[k].hypothesis, ways.back().hypothesis)) continue;
    if (counted && ways[k].share < from) break;
    counted = true;
    const std::vector<double>& before = ways[k].hypothesis.effects.front().parameters;
    for (std::size_t i = 0; i < last.size(); ++i) drift[i] = std::max(drift[i], std::abs(before[i] - last[i]));
  }
  return drift;
}

/// Whether all its strengths may be none, as far as they have drifted.
bool MayBeNone(const Followed& way) {
  const EffectInstance& instance = way.hypothesis.effects.front();
  bool strength = false;
  for (std::size_t i = 0; i < instance.parameters.size(); ++i) {
    const double neutral = instance.effect->info().parameters[i].neutral;
    if (!std::isfinite(neutral)) continue;
    strength = true;
    if (std::abs(instance.parameters[i] - neutral) > way.drift[i]) return false;
  }
  return strength;
}

/// The longest of `ways` that says what a part a stride shorter does, only sharper; nothing below `from`, which is
/// longer than a stride from the first. The longer motion that is chaotic, the narrower the valley in which the fit has
/// to be: from some length on it is caught elsewhere on the way down, and its interval is about a place that means
/// nothing. Parts less than a stride shorter hold the same data, and may be caught in the same place.
std::optional<Followed> Consistent(const EstimationProblem& problem, std::vector<Followed> ways, double from) {
  std::vector<std::optional<Estimate>> settled(ways.size());
  const auto settle = [&](std::size_t k) -> const Estimate& {
    if (!settled[k]) settled[k] = Settled(problem, ways[k]);
    return *settled[k];
  };
  for (; ways.back().share >= from; ways.pop_back()) {
    std::size_t shorter = ways.size() - 1;
    while (shorter > 0 && ways[shorter].share > ways.back().share / kStride * (1.0 + 1e-9)) --shorter;
    const Estimate& last = settle(ways.size() - 1);
    if (!last.ok() || !settle(shorter).ok() || !Sharpens(last, settle(shorter))) continue;
    ways.back().hypothesis = last.hypothesis;
    ways.back().drift = DriftOf(ways, from);
    if (MayBeNone(ways.back())) return std::nullopt;
    return std::move(ways.back());
  }
  return std::nullopt;
}

}  // namespace

void BestFirst(std::vector<Follower>& followers) {
  std::stable_sort(followers.begin(), followers.end(),
                   [](const Follower& a, const Follower& b) { return a.likelihood < b.likelihood; });
}

std::optional<Follower> Fitted(const EstimationProblem& here, const Hypothesis& hypothesis, int rounds) {
  Estimate fit = EstimateAt(here, hypothesis);
  if (!fit.ok()) return std::nullopt;
  const Whitener whitener = WhitenerOf(here, fit, 0);
  fit = Estimator(here, whitener).Refine(std::move(fit), rounds);
  if (!fit.ok()) return std::nullopt;
  return Weighed(here, std::move(fit));
}

std::vector<Follower> FittedBeside(const EstimationProblem& here, const Hypothesis& about,
                                   const std::vector<EffectInstance>& effects) {
  const Result<NuisanceModel> nuisances = LineariseNuisances(here, about, FreedomOf(here, about.effects));
  if (!nuisances.ok()) return {};
  const Estimator estimator(here, Whitener(here.channels(), here.measured() - nuisances->predicted, 0));
  std::vector<std::optional<Follower>> fitted(effects.size());
  ParallelFor(effects.size(), 0, [&](std::size_t k) {
    Estimate fit = estimator.Optimise({effects[k]}, *nuisances, 8);
    if (!fit.ok()) return;
    fitted[k] = Weighed(here, std::move(fit));
    fitted[k]->fit.hypothesis.z =
        about.z;  // the nuisance parameters' shift is linear, and another one beside the effect
  });
  std::vector<Follower> followers;
  for (std::optional<Follower>& one : fitted) {
    if (one) followers.push_back(*std::move(one));
  }
  BestFirst(followers);
  return followers;
}

std::optional<Followed> Follow(const EstimationProblem& problem, double first, std::vector<Hypothesis> starts,
                               const std::function<void(double)>& progress, const Relatives& relatives) {
  std::vector<Followed> ways;  // each longer than the one before
  double stride = kStride, share = first;
  double over = std::numeric_limits<double>::infinity();  // of the leader
  while (!starts.empty()) {
    if (problem.spent()) return std::nullopt;
    progress(std::log(share / first) / std::log(1.0 / first));
    const EstimationProblem here = problem.Part(share);
    std::vector<Follower> followers;
    const auto fit = [&](const std::vector<Hypothesis>& from, int rounds) {
      for (const Hypothesis& start : from) {
        if (std::optional<Follower> on = Fitted(here, start, rounds)) followers.push_back(*std::move(on));
      }
      BestFirst(followers);
    };
    fit(starts, 5);
    if (!followers.empty() && followers.front().over > std::max(relatives ? over : 0.0, kStruggles)) {
      const Hypothesis leader = followers.front().fit.hypothesis;
      fit({leader}, 12);
      if (relatives) fit(relatives(here, leader), 12);
    }
    Thin(followers, static_cast<bool>(relatives));
    if (followers.empty() || followers.front().over > (relatives ? kLost : kAtFloor)) {
      if (relatives || ways.empty()) break;
      // So many impacts more may be too much at once.
      stride = 1.0 + 0.5 * (share / ways.back().share - 1.0);
      if (stride < kShortest) break;
      share = ways.back().share * stride;
      continue;
    }
    if (relatives && LargestDeviation(here, followers.front().fit) > kOffTheLine) break;
    over = followers.front().over;
    starts.clear();
    for (Follower& one : followers) starts.push_back(std::move(one.fit.hypothesis));
    ways.push_back({starts.front(), {starts.begin() + 1, starts.end()}, share, {}});
    if (share == 1.0) break;
    share = std::min(1.0, stride * share);
    stride = std::min(kStride, 1.0 + kRecovers * (stride - 1.0));
  }
  const double least = 2.0 * first;
  if (ways.empty() || over > kAtFloor || ways.back().share < least) return std::nullopt;
  std::optional<Followed> found =
      relatives ? std::optional(std::move(ways.back())) : Consistent(problem, std::move(ways), least);
  if (found && found->share < 1.0 && !Forgets(problem, found->hypothesis)) return std::nullopt;
  return found;
}

}  // namespace dynoproof::diagnosis
