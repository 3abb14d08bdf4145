#include "diagnosis/first_look.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <numbers>
#include <optional>

#include "base/parallel.h"
#include "diagnosis/candidates.h"
#include "diagnosis/policy.h"
#include "linear/dense.h"

namespace dynoproof::diagnosis {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using estimation::Channel;
using estimation::DataSet;
using estimation::Estimate;
using estimation::Fit;
using estimation::Hypothesis;
using estimation::Predictor;

/// A hypothesis without its start: the effect at a place, to be sized by the record.
struct Trial {
  const Effect* effect;
  Place place;
  Hypothesis hypothesis;
  std::vector<VectorXd> starts;        // coordinates of the effect alone
  std::vector<std::size_t> strengths;  // of its parameters, with what grows with them
};

/// The parameters that grow with the size of an effect: its strengths, and what is one of them by something, as the stiffness
/// of a friction that is elastic: the stretch at which it gives way stays.
std::vector<std::size_t> SizedWith(const Effect& effect) {
  std::vector<std::size_t> sized = StrengthsOf(effect);
  const std::vector<EffectParameter>& all = effect.info().parameters;
  const std::vector<std::size_t> strengths = sized;
  for (std::size_t i = 0; i < all.size(); ++i) {
    const bool by = std::ranges::any_of(
        strengths, [&](std::size_t k) { return k != i && all[i].unit.starts_with(all[k].unit + "/"); });
    if (by && std::ranges::find(sized, i) == sized.end()) sized.push_back(i);
  }
  return sized;
}

std::vector<Trial> TrialsOf(const Hypothesis& base, const Levels& levels, const Magnitudes& magnitudes,
                            const Registry& registry) {
  std::vector<Trial> candidates;
  const DataSet& data = levels.data();
  for (const Effect* effect : registry.Effects()) {
    for (const Place& place : effect->Places(base.nominal())) {
      if (!CanBeSeen(place, data.channels(), data.records().front())) continue;
      if (std::ranges::find(base.effects(), Hypothesis::Applied{effect, place}) != base.effects().end()) continue;
      Trial candidate{effect, place, base.With(*effect, place, magnitudes), {}, SizedWith(*effect)};
      const std::size_t first = base.of_effects(), count = effect->info().parameters.size();
      const auto& parameters = candidate.hypothesis.parameters();
      for (const std::vector<double>& start : effect->Starts(base.nominal(), place, magnitudes)) {
        VectorXd q(static_cast<Index>(count));
        for (std::size_t i = 0; i < count; ++i) {
          const estimation::Parameter& own = parameters[first + i];
          q[static_cast<Index>(i)] = own.CoordinateOf(std::clamp(start[i], own.lower, own.upper));
        }
        candidate.starts.push_back(std::move(q));
      }
      candidates.push_back(std::move(candidate));
    }
  }
  return candidates;
}

/// Size of a candidate by one run beside the null, and the share of the error that it removes and that
/// nominal values cannot.
struct Signature {
  double size = 0.0, removes = -1.0;
};

class Screen {
 public:
  Screen(const Contestant& null, const Predictor& predictor, std::size_t level)
      : null_(null), predictor_(predictor), estimate_(null.levels[level]) {
    const MatrixXd& J = estimate_.jacobian;
    if (J.cols() == 0) return;
    MatrixXd H = J.transpose() * J;
    for (Index i = 0; i < H.rows(); ++i) {
      if (null.hypothesis.parameters()[static_cast<std::size_t>(i)].prior) H(i, i) += 1.0;
    }
    inverse_ = dense::PseudoInverse(H);
  }

  Signature Of(const Hypothesis& hypothesis, const VectorXd& q) const {
    const Result<VectorXd> with = predictor_.Innovations(hypothesis.At(q));
    if (!with.ok()) return {};
    VectorXd g = estimate_.innovations - *with;
    const DataSet& data = predictor_.data();
    for (std::size_t c = 0; c < data.channels().size(); ++c) {
      const Channel& channel = data.channels()[c];
      g.segment(channel.begin, channel.count) /= estimate_.scales[c].rms * std::sqrt(estimate_.scales[c].correlation);
    }
    const MatrixXd& J = estimate_.jacobian;
    if (J.cols() > 0) g -= J * (inverse_ * (J.transpose() * g));
    const double power = g.squaredNorm(), along = g.dot(estimate_.weighted);
    if (!(power > 0.0)) return {};
    return {along / power, along * along / (power * estimate_.weighted.squaredNorm())};
  }

 private:
  const Contestant& null_;
  const Predictor& predictor_;
  const Estimate& estimate_;
  MatrixXd inverse_;
};

constexpr double kLeastSize = 0.02, kMostSize = 50.0;  // of a start

double Bounded(double size) { return std::copysign(std::clamp(std::abs(size), kLeastSize, kMostSize), size); }

/// Where the numbers of the candidate itself begin.
Index OwnOf(const Trial& candidate) {
  return static_cast<Index>(candidate.hypothesis.of_effects() - candidate.effect->info().parameters.size());
}

/// The start that removes most, as large as the record asks for.
VectorXd SizedStart(const Trial& candidate, const Screen& screen, const VectorXd& from) {
  const Index own = OwnOf(candidate);
  VectorXd best = from;
  double removes = -1.0;
  for (const VectorXd& start : candidate.starts) {
    VectorXd q = from;
    q.segment(own, start.size()) = start;
    const Signature signature = screen.Of(candidate.hypothesis, q);
    // A strength that is bounded to one sign removes nothing where the record asks for the other sign.
    VectorXd sized = q;
    const double size = Bounded(signature.size);
    bool forbidden = false;
    for (const std::size_t i : candidate.strengths) {
      const auto at = own + static_cast<Index>(i);
      sized[at] = size * q[at];
      forbidden = forbidden || (size < 0.0 && (sized[at] < candidate.hypothesis.lower()[at] ||
                                               sized[at] > candidate.hypothesis.upper()[at]));
    }
    if (forbidden) sized = q;
    const double counts = forbidden ? 0.0 : signature.removes;
    if (counts > removes) removes = counts, best = sized;
  }
  return best;
}

/// A sin(n phi + theta), in this order, is a sine and a cosine of one order, each with a size of its own: of the order of which
/// both together remove most.
VectorXd HarmonicStart(const Trial& candidate, const Screen& screen, const VectorXd& from) {
  const Index own = OwnOf(candidate);
  const auto& parameters = candidate.hypothesis.parameters();
  const estimation::Parameter& phase = parameters[static_cast<std::size_t>(own) + 2];
  VectorXd best = from;
  double removes = -1.0;
  for (const VectorXd& start : candidate.starts) {
    VectorXd q = from;
    q.segment(own, start.size()) = start;
    q[own + 2] = phase.CoordinateOf(0.0);
    const Signature sine = screen.Of(candidate.hypothesis, q);
    q[own + 2] = phase.CoordinateOf(0.5 * std::numbers::pi);
    const Signature cosine = screen.Of(candidate.hypothesis, q);
    if (!(sine.removes + cosine.removes > removes)) continue;
    removes = sine.removes + cosine.removes;
    best = q;
    best[own] = Bounded(std::hypot(sine.size, cosine.size)) * q[own];
    best[own + 2] = phase.CoordinateOf(std::atan2(cosine.size, sine.size));
  }
  return best;
}

/// One cheap fit from the start that removes most, sized by it.
Contestant LookAt(const Trial& candidate, const Contestant& null, const Levels& levels, std::size_t level) {
  Contestant contestant(candidate.hypothesis);
  contestant.levels.resize(levels.size());
  for (Estimate& estimate : contestant.levels) estimate.broken = "not fitted";
  const VectorXd from = StartFrom(candidate.hypothesis, null.hypothesis, null.levels[level].q);
  const Screen screen(null, levels[level], level);
  VectorXd best = candidate.effect->info().traits.harmonic ? HarmonicStart(candidate, screen, from)
                                                           : SizedStart(candidate, screen, from);
  const estimation::KnownColumns known{&null.hypothesis, &null.levels[level]};
  contestant.levels[level] =
      AsLoudAs(null, level,
               Fit(candidate.hypothesis, levels[level], best,
                   {.iterations = 6, .renewals = 1, .of_excess = policy::kLookedAt, .near = true, .known = known}));
  const auto share = [&](std::size_t at) { return ShareOf(contestant, null, levels, at); };
  if (contestant.Holds(level)) contestant.share = share(level), best = contestant.levels[level].q;
  // And at the next level: a strong correction leaves little of what only accumulates.
  const std::size_t next = level + 1;
  if (next < levels.size() && null.Holds(next)) {
    const estimation::KnownColumns columns{&null.hypothesis, &null.levels[next]};
    contestant.levels[next] =
        AsLoudAs(null, next,
                 Fit(candidate.hypothesis, levels[next], best,
                     {.iterations = 6, .renewals = 1, .of_excess = policy::kLookedAt, .near = true, .known = columns}));
    if (contestant.Holds(next)) contestant.share = std::max(contestant.share, share(next));
  }
  return contestant;
}

}  // namespace

std::vector<Contestant> FirstLook(const Contestant& null, const Levels& levels, std::size_t level,
                                  const Magnitudes& magnitudes, const Registry& registry,
                                  const std::function<void(double)>& progress) {
  const std::vector<Trial> candidates = TrialsOf(null.hypothesis, levels, magnitudes, registry);
  std::vector<std::optional<Contestant>> seen(candidates.size());
  std::atomic<std::size_t> done = 0;
  ParallelFor(candidates.size(), 0, [&](std::size_t i) {
    seen[i] = LookAt(candidates[i], null, levels, level);
    progress(static_cast<double>(++done) / static_cast<double>(candidates.size()));
  });
  std::vector<Contestant> ranked;
  for (std::optional<Contestant>& one : seen) {
    if (one->Holds(level) || one->Holds(level + 1)) ranked.push_back(*std::move(one));
  }
  std::ranges::stable_sort(ranked, [](const Contestant& a, const Contestant& b) { return a.share > b.share; });
  return ranked;
}

}  // namespace dynoproof::diagnosis
