#include "diagnosis/contest.h"

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>
#include <numbers>
#include <span>

#include "base/parallel.h"
#include "diagnosis/candidates.h"
#include "diagnosis/policy.h"

namespace dynoproof::diagnosis {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using estimation::Channel;
using estimation::ChannelScale;
using estimation::DataSet;
using estimation::Estimate;
using estimation::Fit;
using estimation::Hypothesis;
using estimation::LinearModel;
using estimation::Predictor;

constexpr const char* kNotFitted = "not fitted";

/// Standard error of a channel's power, of itself.
double PowerError(const ChannelScale& scale, const Channel& channel) {
  return std::sqrt(2.0 * scale.correlation / static_cast<double>(std::max<Index>(1, channel.count)));
}

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

/// The null's estimate as a start for a hypothesis with more effects: its own numbers by their names.
VectorXd StartFrom(const Hypothesis& hypothesis, const Hypothesis& other, const VectorXd& q) {
  VectorXd start = hypothesis.start();
  for (std::size_t i = 0; i < hypothesis.parameters().size(); ++i) {
    const auto same =
        std::ranges::find(other.parameters(), hypothesis.parameters()[i].name, &estimation::Parameter::name);
    if (same != other.parameters().end()) start[static_cast<Index>(i)] = q[same - other.parameters().begin()];
  }
  return start;
}

/// What one run beside the null says of a candidate: how large it should be, and which share of the error it removes that
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
    inverse_ = H.completeOrthogonalDecomposition().pseudoInverse();
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

/// A hypothesis whose own loop is louder than the nominal one's may not excuse what it leaves with that.
Estimate AsLoudAs(const Contestant& null, std::size_t level, Estimate estimate) {
  if (!estimate.ok() || !null.Holds(level)) return estimate;
  for (std::size_t c = 0; c < estimate.scales.size(); ++c)
    estimate.scales[c].noise_alone = std::min(estimate.scales[c].noise_alone, null.levels[level].scales[c].noise_alone);
  return estimate;
}

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
Contestant FirstLook(const Trial& candidate, const Contestant& null, const Levels& levels, std::size_t level) {
  Contestant contestant(candidate.hypothesis);
  contestant.levels.resize(levels.size());
  for (Estimate& estimate : contestant.levels) estimate.broken = kNotFitted;
  const VectorXd from = StartFrom(candidate.hypothesis, null.hypothesis, null.levels[level].q);
  const Screen screen(null, levels[level], level);
  VectorXd best = candidate.effect->info().traits.harmonic ? HarmonicStart(candidate, screen, from)
                                                           : SizedStart(candidate, screen, from);
  const estimation::KnownColumns known{&null.hypothesis, &null.levels[level]};
  contestant.levels[level] = AsLoudAs(
      null, level,
      Fit(candidate.hypothesis, levels[level], best, {.iterations = 6, .renewals = 1, .near = true, .known = known}));
  const auto share = [&](std::size_t at) { return ShareOf(contestant, null, levels, at); };
  if (contestant.Holds(level)) contestant.share = share(level), best = contestant.levels[level].q;
  // And at the next level: a strong correction leaves little of what only accumulates.
  const std::size_t next = level + 1;
  if (next < levels.size() && null.Holds(next)) {
    const estimation::KnownColumns columns{&null.hypothesis, &null.levels[next]};
    contestant.levels[next] = AsLoudAs(null, next,
                                       Fit(candidate.hypothesis, levels[next], best,
                                           {.iterations = 6, .renewals = 1, .near = true, .known = columns}));
    if (contestant.Holds(next)) contestant.share = std::max(contestant.share, share(next));
  }
  return contestant;
}

/// Where a fit begins at a level: where the level before has come to, or at the null's values of this level, whichever leaves
/// less. Where both are worse than the null itself, it begins there, with an effect that does next to nothing.
VectorXd BestStart(const Contestant& contestant, const Contestant& null, const Levels& levels, std::size_t level,
                   const VectorXd& from) {
  if (!null.Holds(level)) return from;
  const Hypothesis& hypothesis = contestant.hypothesis;
  const auto own = static_cast<Index>(hypothesis.of_effects());
  const auto excess = [&](const VectorXd& q) {
    const Result<VectorXd> rows = levels[level].Innovations(hypothesis.At(q));
    if (!rows.ok()) return std::numeric_limits<double>::infinity();
    VectorXd noise(std::ssize(levels.data().channels()));
    for (Index c = 0; c < noise.size(); ++c)
      noise[c] = null.levels[level].scales[static_cast<std::size_t>(c)].noise_alone;
    return LogExcess(estimation::ScalesOf(levels.data(), *rows, noise), levels.data());
  };
  VectorXd here = StartFrom(hypothesis, null.hypothesis, null.levels[level].q);
  const auto count = static_cast<Index>(contestant.effect().info().parameters.size());
  here.segment(own - count, count) = from.segment(own - count, count);
  const double of_from = excess(from), of_here = excess(here);
  if (std::min(of_from, of_here) <= LogExcess(null.levels[level].scales, levels.data()))
    return of_from <= of_here ? from : here;
  constexpr double kNextToNothing = 0.01;  // of where it was
  for (Index i = own - count; i < own; ++i) {
    const estimation::Parameter& parameter = hypothesis.parameters()[static_cast<std::size_t>(i)];
    if (!parameter.neutral) continue;
    const double neutral = parameter.CoordinateOf(*parameter.neutral);
    here[i] = neutral + kNextToNothing * (from[i] - neutral);
  }
  return here;
}

/// At one level: with the null's columns as far as they lead, then with its own.
Estimate FitWith(const Contestant& contestant, const Contestant& null, const Levels& levels, std::size_t level,
                 const VectorXd& from) {
  VectorXd near = BestStart(contestant, null, levels, level, from);
  if (null.Holds(level)) {
    const estimation::KnownColumns known{&null.hypothesis, &null.levels[level]};
    const Estimate rough = Fit(contestant.hypothesis, levels[level], near,
                               {.iterations = 10, .renewals = 2, .near = true, .known = known});
    if (rough.ok()) near = rough.q;
  }
  return AsLoudAs(null, level, Fit(contestant.hypothesis, levels[level], near, {.renewals = 6, .near = true}));
}

/// Whether a model may be exact where its run is corrected less: it is near the noise here.
bool NearTheNoise(const Estimate& estimate) {
  constexpr double kNear = 3.0;
  return std::ranges::all_of(estimate.scales,
                             [](const ChannelScale& one) { return one.rms <= kNear * one.noise_alone; });
}

/// From their first look through all levels, side by side. What removes next to nothing where another removes most is not
/// followed further; and memories beyond the record's length, which lead to the exact minimum of the free run, are only for a
/// model that is near the noise before.
void Carry(std::span<Contestant> contestants, const Contestant& null, const Levels& levels, std::size_t first,
           const std::function<void(double)>& progress) {
  std::vector<VectorXd> from;
  for (const Contestant& one : contestants) from.push_back(one.levels[one.Holds(first) ? first : first + 1].q);
  std::vector<bool> followed(contestants.size(), true);
  for (std::size_t level = first; level < levels.size(); ++level) {
    const bool between = level > levels.longest() && level < levels.free_run();
    ParallelFor(contestants.size(), 0, [&](std::size_t i) {
      Contestant& own = contestants[i];
      const std::size_t before = std::min(levels.longest(), level);
      if (!followed[i] || (between && own.Holds(before) && !NearTheNoise(own.levels[before]))) {
        own.levels[level].broken = kNotFitted;
        return;
      }
      Estimate estimate = FitWith(own, null, levels, level, from[i]);
      if (estimate.ok()) from[i] = estimate.q;
      own.levels[level] = std::move(estimate);
    });
    progress(static_cast<double>(level - first + 1) / static_cast<double>(levels.size() - first));
    if (level == first || !null.Holds(level)) continue;
    double most = 0.0;
    for (const Contestant& one : contestants) {
      if (one.Holds(level)) most = std::max(most, ShareOf(one, null, levels, level));
    }
    for (std::size_t i = 0; i < contestants.size(); ++i) {
      bool little = most >= policy::kMost;
      for (std::size_t seen = first; seen <= level; ++seen) {
        if (contestants[i].Holds(seen) && null.Holds(seen))
          little = little && ShareOf(contestants[i], null, levels, seen) < policy::kLittle;
      }
      if (little) followed[i] = false;
    }
  }
}

/// A law is carried with the plainer one that it refines at its place, from the same values: of the two the plainer one is
/// named where it does. Both stand among the first, of which there are as many as is told.
std::size_t WithPlainerLaws(std::vector<Contestant>& ranked, std::size_t kept, std::size_t first) {
  for (std::size_t i = 0; i < kept; ++i) {
    const std::string& refines = ranked[i].effect().info().traits.refines;
    const auto plainer = std::find_if(ranked.begin(), ranked.end(), [&](const Contestant& one) {
      return one.effect().info().name == refines && one.place() == ranked[i].place();
    });
    if (refines.empty() || plainer == ranked.end()) continue;
    const std::size_t level = ranked[i].Holds(first) ? first : first + 1;
    if (plainer->Holds(level) && ranked[i].Holds(level) && plainer->share < ranked[i].share) {
      const auto own = static_cast<std::ptrdiff_t>(plainer->hypothesis.of_effects());
      VectorXd& q = plainer->levels[level].q;
      q = StartFrom(plainer->hypothesis, ranked[i].hypothesis, ranked[i].levels[level].q);
      const auto count = static_cast<std::ptrdiff_t>(plainer->effect().info().parameters.size());
      for (std::ptrdiff_t k = own - count; k < own; ++k) {
        const auto number = [](const estimation::Parameter& one) { return one.name.substr(one.name.rfind(' ') + 1); };
        const estimation::Parameter& to = plainer->hypothesis.parameters()[static_cast<std::size_t>(k)];
        const auto& others = ranked[i].hypothesis.parameters();
        for (std::size_t n = 0; n < ranked[i].hypothesis.of_effects(); ++n) {
          if (number(others[n]) == number(to))
            q[k] = to.CoordinateOf(others[n].ValueAt(ranked[i].levels[level].q[static_cast<Index>(n)]));
        }
      }
    }
    if (plainer - ranked.begin() >= static_cast<std::ptrdiff_t>(kept)) {
      std::rotate(ranked.begin() + static_cast<std::ptrdiff_t>(kept), plainer, plainer + 1);
      ++kept;
    }
  }
  return kept;
}

/// Once more from the values that another model has found, where that ends lower.
void FitFrom(Contestant& contestant, const Contestant& other, const Contestant& null, const Levels& levels,
             std::size_t level) {
  constexpr double kWorth = 1e-3;  // of the logarithm of the excess
  if (!other.Holds(level) || contestant.levels[level].broken == kNotFitted) return;
  VectorXd from = StartFrom(contestant.hypothesis, other.hypothesis, other.levels[level].q);
  const auto own = static_cast<Index>(contestant.hypothesis.of_effects());
  if (contestant.Holds(level)) from.head(own) = contestant.levels[level].q.head(own);
  // Its own columns do for a few steps; only what ends lower is worth new ones.
  const bool known = contestant.Holds(level);
  const estimation::KnownColumns own_columns{&contestant.hypothesis, known ? &contestant.levels[level] : nullptr};
  Estimate again = AsLoudAs(
      null, level,
      Fit(contestant.hypothesis, levels[level], from,
          {.iterations = 8, .renewals = 1, .near = true, .known = known ? std::optional(own_columns) : std::nullopt}));
  const auto worth = [&](const Estimate& estimate) { return LogExcess(estimate.scales, levels.data()); };
  if (!again.ok() || (known && !(worth(again) < worth(contestant.levels[level]) - kWorth))) return;
  if (known)
    again = AsLoudAs(null, level, Fit(contestant.hypothesis, levels[level], again.q, {.renewals = 6, .near = true}));
  if (again.ok()) contestant.levels[level] = std::move(again);
}

}  // namespace

Result<std::unique_ptr<Levels>> Levels::Of(const Plan& plan, const std::vector<MappedRecord>& records,
                                           const Registry& registry, double compared_from_s, Index most_rows,
                                           const Levels* like, double most_s) {
  std::unique_ptr<Levels> levels(new Levels());
  const DataSet whole(records, plan);
  const Result<LinearModel> model = LinearModel::Of(plan, whole.records().front(), registry);
  if (!model.ok()) return model.failure();
  levels->model_ = *model;
  const double duration_s = std::min(whole.records().front().end_s, most_s);
  const double memory_s = estimation::MemoryFor(*model, duration_s);
  double from_s = compared_from_s;
  if (!(from_s > 0.0) && std::ranges::any_of(whole.records(), &MappedRecord::in_motion))
    from_s = estimation::LeadInOf(memory_s, duration_s);
  levels->data_ = std::make_unique<DataSet>(
      records, plan, DataSet::Options{.from_s = from_s, .most_s = most_s, .most_rows = most_rows});
  const auto known = std::make_shared<mechanics::Decompositions>();
  if (like != nullptr) {
    levels->memories_s_ = like->memories_s_;
    levels->corrected_ = like->corrected_;
    levels->longest_ = like->longest_;
  } else {
    // Between a memory and the free run the error has ever more minima: steps are small up to beyond the record's length.
    for (double memory = memory_s; levels->memories_s_.empty() || memory < policy::kLongest * duration_s;
         memory *= policy::kLonger) {
      const std::size_t level = levels->memories_s_.size();
      if (memory < policy::kMostOfRecord * duration_s) levels->longest_ = level;
      levels->corrected_ = std::min<std::size_t>(levels->longest_, 1);
      levels->memories_s_.push_back(memory);
    }
  }
  for (const double memory : levels->memories_s_)
    levels->predictors_.push_back(std::make_unique<Predictor>(*levels->data_, levels->model_, registry, memory, known));
  levels->predictors_.push_back(
      from_s > 0.0 ? std::make_unique<Predictor>(*levels->predictors_.front(), from_s)
                   : std::make_unique<Predictor>(*levels->data_, levels->model_, registry, std::nullopt, known));
  return levels;
}

std::string Levels::Name(std::size_t level) const {
  return level == free_run() ? "free run" : fmt::format("memory {:.3g} s", predictors_[level]->observer()->memory_s());
}

std::int64_t Levels::simulations() const {
  std::int64_t sum = 0;
  for (const auto& predictor : predictors_) sum += predictor->simulations();
  return sum;
}

bool IsExact(const Estimate& estimate) {
  return std::ranges::all_of(
      estimate.scales, [](const ChannelScale& scale) { return scale.rms <= policy::kNoiseSize * scale.noise_alone; });
}

bool HasExcess(const Estimate& estimate, const DataSet& data) {
  for (std::size_t c = 0; c < estimate.scales.size(); ++c) {
    const ChannelScale& scale = estimate.scales[c];
    const double excess = std::pow(scale.rms / scale.noise_alone, 2) - 1.0;
    if (excess > std::min(policy::kExcess, policy::kExcessErrors * PowerError(scale, data.channels()[c]))) return true;
  }
  return false;
}

double LogExcess(const std::vector<ChannelScale>& scales, const DataSet& data) {
  double sum = 0.0;
  for (std::size_t c = 0; c < scales.size(); ++c) {
    const double noise = std::pow(scales[c].noise_alone, 2), power = std::pow(scales[c].rms, 2);
    const double seen = std::max(policy::kNoiseKnown, 2.0 * PowerError(scales[c], data.channels()[c]));
    sum += std::log(std::max(power - noise, seen * noise));
  }
  return sum / static_cast<double>(std::max<std::size_t>(1, scales.size()));
}

double ShareOf(const Contestant& contestant, const Contestant& null, const Levels& levels, std::size_t level) {
  return 1.0 - std::exp(LogExcess(contestant.levels[level].scales, levels.data()) -
                        LogExcess(null.levels[level].scales, levels.data()));
}

Contestant NullOf(const Plan& plan, bool released, const Levels& levels, const Registry& registry) {
  const Hypothesis base(plan);
  Contestant null(released ? base.WithNominalValuesReleased(registry) : base.WithNominalValuesFree(registry));
  std::vector<const Predictor*> order;
  for (std::size_t level = 0; level < levels.size(); ++level) order.push_back(&levels[level]);
  null.levels = estimation::FitThrough(null.hypothesis, order, null.hypothesis.start(), {.renewals = 6, .near = true});
  return null;
}

Result<Contest> Compete(Contestant null, bool released, const Levels& levels, const Magnitudes& magnitudes,
                        const Registry& registry, const std::function<void(double)>& progress) {
  Contest contest;
  contest.released = released;
  std::int64_t counted = levels.simulations();
  const auto count = [&](const char* stage) {
    contest.cost.push_back({stage, levels.simulations() - counted});
    counted = levels.simulations();
  };
  // The most corrected level at which anything is left to explain; the free run where nowhere is.
  contest.first = levels.size();
  for (std::size_t level = 0; level < levels.size(); ++level) {
    if (!null.Holds(level)) continue;
    contest.first = level;
    if (HasExcess(null.levels[level], levels.data())) break;
  }
  if (contest.first == levels.size())
    return Failure{"the nominal model breaks beside the record: " + null.levels.front().broken,
                   null.hypothesis.nominal().id};
  progress(0.1);
  const std::vector<Trial> candidates = TrialsOf(null.hypothesis, levels, magnitudes, registry);
  std::vector<std::optional<Contestant>> seen(candidates.size());
  std::atomic<std::size_t> done = 0;
  ParallelFor(candidates.size(), 0, [&](std::size_t i) {
    seen[i] = FirstLook(candidates[i], null, levels, contest.first);
    progress(0.1 + 0.4 * static_cast<double>(++done) / static_cast<double>(candidates.size()));
  });
  count("first look");
  std::vector<Contestant> ranked;
  for (std::optional<Contestant>& one : seen) {
    if (one->Holds(contest.first) || one->Holds(contest.first + 1)) ranked.push_back(*std::move(one));
  }
  std::ranges::stable_sort(ranked, [](const Contestant& a, const Contestant& b) { return a.share > b.share; });
  std::size_t kept =
      std::min(null.hypothesis.effects().empty() ? policy::kCarried : policy::kCarriedOnTop, ranked.size());
  kept = WithPlainerLaws(ranked, kept, contest.first);
  Carry({ranked.data(), kept}, null, levels, contest.first, [&](double share) { progress(0.5 + 0.4 * share); });
  count("through the levels");
  contest.contestants.push_back(std::move(null));
  for (std::size_t i = 0; i < ranked.size(); ++i)
    (i < kept ? contest.contestants : contest.left_behind).push_back(std::move(ranked[i]));
  // All, and the null, once more from the values that the leader has found.
  for (std::size_t level = contest.first; level < levels.size(); ++level) {
    const Contestant* leader = nullptr;
    for (const Contestant& one : contest.contestants) {
      if (one.Holds(level) && (leader == nullptr || LogExcess(one.levels[level].scales, levels.data()) <
                                                        LogExcess(leader->levels[level].scales, levels.data())))
        leader = &one;
    }
    if (leader == nullptr) continue;
    const Contestant before = contest.null();
    ParallelFor(contest.contestants.size(), 0, [&](std::size_t i) {
      if (&contest.contestants[i] != leader) FitFrom(contest.contestants[i], *leader, before, levels, level);
    });
  }
  count("from the leader's values");
  progress(1.0);
  return contest;
}

}  // namespace dynoproof::diagnosis
