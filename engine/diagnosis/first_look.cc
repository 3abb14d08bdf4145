#include "diagnosis/first_look.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <numbers>
#include <optional>

#include "base/parallel.h"
#include "diagnosis/policy.h"
#include "diagnosis/trial.h"
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

/// Size of a candidate by one run beside the null, and the share of the error that it removes and that
/// nominal values cannot.
struct Signature {
  double size = 0.0, removes = -1.0;
};

class Screen {
 public:
  Screen(const Contestant& null, const Predictor& predictor, std::size_t level)
      : predictor_(predictor),
        estimate_(null.levels[level]),
        inverse_(estimation::CurvatureOf(estimate_, null.hypothesis)) {}

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
  const Predictor& predictor_;
  const Estimate& estimate_;
  MatrixXd inverse_;
};

constexpr double kLeastSize = 0.02, kMostSize = 50.0;  // of a start

double Bounded(double size) { return std::copysign(std::clamp(std::abs(size), kLeastSize, kMostSize), size); }

/// A point from which a candidate may be fitted, and the share of the error that it removes there, linear.
struct Sketch {
  VectorXd q;
  double removes = -1.0;
};

/// The start that removes most, as large as the record asks for.
Sketch SizedStart(const Trial& candidate, const Screen& screen, const VectorXd& from) {
  const Index own = candidate.own();
  Sketch best{from};
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
    if (counts > best.removes) best = {sized, counts};
  }
  return best;
}

/// A sin(n phi + theta), in this order, is a sine and a cosine of one order, each with a size of its own: of the order of which
/// both together remove most.
Sketch HarmonicStart(const Trial& candidate, const Screen& screen, const VectorXd& from) {
  const Index own = candidate.own();
  const auto& parameters = candidate.hypothesis.parameters();
  const estimation::Parameter& phase = parameters[static_cast<std::size_t>(own) + 2];
  Sketch best{from};
  for (const VectorXd& start : candidate.starts) {
    VectorXd q = from;
    q.segment(own, start.size()) = start;
    q[own + 2] = phase.CoordinateOf(0.0);
    const Signature sine = screen.Of(candidate.hypothesis, q);
    q[own + 2] = phase.CoordinateOf(0.5 * std::numbers::pi);
    const Signature cosine = screen.Of(candidate.hypothesis, q);
    if (!(sine.removes + cosine.removes > best.removes)) continue;
    best = {q, sine.removes + cosine.removes};
    best.q[own] = Bounded(std::hypot(sine.size, cosine.size)) * q[own];
    best.q[own + 2] = phase.CoordinateOf(std::atan2(cosine.size, sine.size));
  }
  return best;
}

/// A level and the next one: a strong correction leaves little of what only accumulates.
struct Screens {
  Screen here;
  std::optional<Screen> next;

  Screens(const Contestant& null, const Levels& levels, std::size_t level) : here(null, levels[level], level) {
    if (level + 1 < levels.size() && null.Holds(level + 1)) next.emplace(null, levels[level + 1], level + 1);
  }
};

/// What a candidate promises, by runs beside the null alone: at its start, and at the size that comes out of that.
Sketch SketchOf(const Trial& candidate, const Screens& screens, const VectorXd& from) {
  Sketch sketch = candidate.effect->info().traits.harmonic ? HarmonicStart(candidate, screens.here, from)
                                                           : SizedStart(candidate, screens.here, from);
  if (sketch.removes == 0.0) return sketch;
  sketch.removes = std::max(sketch.removes, screens.here.Of(candidate.hypothesis, sketch.q).removes);
  if (screens.next) sketch.removes = std::max(sketch.removes, screens.next->Of(candidate.hypothesis, sketch.q).removes);
  return sketch;
}

/// How many of the sketches, in this order, are worth a fit. Where the null leaves an excess, as many as are affordable. Where
/// it leaves none, those whose score test (Rao 1948) says that they remove more than noise lets a candidate remove by chance,
/// and the first few in any case, for the report.
std::size_t WorthFitting(const Contestant& null, const Levels& levels, std::size_t level,
                         const std::vector<std::size_t>& order, const std::vector<Sketch>& sketches) {
  const Estimate& estimate = null.levels[level];
  if (HasExcess(estimate, levels.data())) return policy::kLookedAtMost;
  const double power = estimate.weighted.squaredNorm();  // of rows that noise alone makes about one each
  const auto chance =
      std::ranges::find_if(order, [&](std::size_t i) { return sketches[i].removes * power < policy::kByChance; });
  return std::clamp<std::size_t>(static_cast<std::size_t>(chance - order.begin()), policy::kLookedAtLeast,
                                 policy::kLookedAtMost);
}

/// A cheap fit at a level, and at the next one.
Contestant FitOnce(const Trial& candidate, VectorXd from, const Contestant& null, const Levels& levels,
                   std::size_t level) {
  Contestant contestant(candidate.hypothesis);
  contestant.levels.resize(levels.size());
  for (Estimate& estimate : contestant.levels) estimate.broken = "not fitted";
  for (std::size_t at = level; at < std::min(level + 2, levels.size()); ++at) {
    if (!null.Holds(at)) continue;
    const estimation::KnownColumns known{&null.hypothesis, &null.levels[at]};
    contestant.levels[at] = AsLoudAs(null, at,
                                     Fit(candidate.hypothesis, levels[at], from,
                                         {.iterations = 6,
                                          .renewals = at == level ? 4 : 1,  // at the next level it is near already
                                          .points = policy::kLookedAtPoints,
                                          .of_excess = policy::kLookedAt,
                                          .near = true,
                                          .known = known}));
    if (!contestant.Holds(at)) continue;
    contestant.share = std::max(contestant.share, ShareOf(contestant, null, levels, at));
    if (at == level) from = contestant.levels[at].q;
  }
  for (Estimate& estimate : contestant.levels) estimate.DropRows();  // of some dozen candidates a few are fitted again
  return contestant;
}

}  // namespace

std::vector<Contestant> FirstLook(const Contestant& null, const Levels& levels, std::size_t level,
                                  const Magnitudes& magnitudes, const Registry& registry, const Conduct& conduct) {
  constexpr std::size_t kAtOnce = 16;  // between two questions whether to go on
  constexpr double kSketched = 0.6;    // of the work
  const std::vector<Trial> candidates = TrialsOf(null.hypothesis, levels, magnitudes, registry);
  const Screens screens(null, levels, level);
  std::atomic<std::size_t> done = 0;
  const auto in_parts = [&](std::size_t count, double from, double to, const auto& work) {
    done = 0;
    for (std::size_t begin = 0; begin < count && !conduct.spent(); begin += kAtOnce) {
      ParallelFor(std::min(kAtOnce, count - begin), 0, [&](std::size_t i) {
        work(begin + i);
        conduct.progress(from + (to - from) * static_cast<double>(++done) / static_cast<double>(count));
      });
    }
  };
  std::vector<Sketch> sketches(candidates.size());
  in_parts(candidates.size(), 0.0, kSketched, [&](std::size_t i) {
    const VectorXd from = StartFrom(candidates[i].hypothesis, null.hypothesis, null.levels[level].q);
    const std::string name = candidates[i].hypothesis.Name() + ", first look";
    if (const std::optional<VectorXd> known = conduct.Recall(name, level, from.size() + 1))
      sketches[i] = {known->head(from.size()), known->tail(1)[0]};
    else
      sketches[i] = SketchOf(candidates[i], screens, from);
    VectorXd kept(from.size() + 1);
    kept << sketches[i].q, sketches[i].removes;
    conduct.Keep(name, level, kept);
  });
  std::vector<std::size_t> order;
  for (std::size_t i = 0; i < candidates.size(); ++i) {
    if (sketches[i].removes >= 0.0) order.push_back(i);
  }
  std::ranges::stable_sort(order,
                           [&](std::size_t a, std::size_t b) { return sketches[a].removes > sketches[b].removes; });
  order.resize(std::min(order.size(), WorthFitting(null, levels, level, order, sketches)));
  std::vector<std::optional<Contestant>> seen(order.size());
  in_parts(order.size(), kSketched, 1.0,
           [&](std::size_t i) { seen[i] = FitOnce(candidates[order[i]], sketches[order[i]].q, null, levels, level); });
  std::vector<Contestant> ranked;
  for (std::optional<Contestant>& one : seen) {
    if (one && (one->Holds(level) || one->Holds(level + 1))) ranked.push_back(*std::move(one));
  }
  std::ranges::stable_sort(ranked, [](const Contestant& a, const Contestant& b) { return a.share > b.share; });
  return ranked;
}

}  // namespace dynoproof::diagnosis
