#include "diagnosis/sketch.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "diagnosis/policy.h"

namespace dynoproof::diagnosis {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using estimation::Hypothesis;

constexpr double kLeastSize = 0.02, kMostSize = 50.0;  // of a start

double Bounded(double size) { return std::copysign(std::clamp(std::abs(size), kLeastSize, kMostSize), size); }

/// The start that removes most, as large as the record asks for.
Sketch SizedStart(const Trial& candidate, const Screen& screen, const VectorXd& from) {
  const Index own = candidate.own();
  Sketch best{from};
  for (const VectorXd& start : candidate.starts) {
    VectorXd q = from;
    q.segment(own, start.size()) = start;
    const Signature signature = screen.Of(candidate.hypothesis, q);
    best.Saw(signature);
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
    if (counts > best.removes) best = {sized, counts, best.moves};
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
    best.Saw(sine);
    best.Saw(cosine);
    if (!(sine.removes + cosine.removes > best.removes)) continue;
    best = {q, sine.removes + cosine.removes, best.moves};
    best.q[own] = Bounded(std::hypot(sine.size, cosine.size)) * q[own];
    best.q[own + 2] = phase.CoordinateOf(std::atan2(cosine.size, sine.size));
  }
  return best;
}

}  // namespace

void Sketch::Saw(const Signature& signature) {
  if (signature.ran) moves = std::max(moves.value_or(0.0), signature.moves);
}

bool Sketch::IsSilent() const { return moves && *moves < policy::kUnseen; }

NotTestable Silence(const Trial& candidate) {
  return {candidate.effect->info().name, candidate.place.ToString(),
          "at no size that was tried does it move an output by a tenth of the noise"};
}

Screen::Screen(const Contestant& null, const estimation::Predictor& predictor, std::size_t level)
    : predictor_(predictor),
      estimate_(null.levels[level]),
      inverse_(estimation::CurvatureOf(estimate_, null.hypothesis)) {}

Signature Screen::Of(const Hypothesis& hypothesis, const VectorXd& q) const {
  const Result<VectorXd> with = predictor_.Innovations(hypothesis.At(q));
  if (!with.ok()) return {};
  VectorXd g = estimate_.innovations - *with;
  Signature signature;
  signature.ran = true;
  for (std::size_t c = 0; c < estimate_.scales.size(); ++c) {
    const estimation::Channel& channel = predictor_.data().channels()[c];
    const double rms =
        g.segment(channel.begin, channel.count).norm() / std::sqrt(std::max(1.0, static_cast<double>(channel.count)));
    signature.moves = std::max(signature.moves, rms / estimate_.scales[c].noise_alone);
  }
  WeighAs(estimate_, predictor_.data(), g);
  const MatrixXd& J = estimate_.jacobian;
  if (J.cols() > 0) g -= J * (inverse_ * (J.transpose() * g));
  const double power = g.squaredNorm(), along = g.dot(estimate_.weighted);
  if (!(power > 0.0)) return signature;
  signature.size = along / power;
  const double left = estimate_.weighted.squaredNorm();
  signature.removes = left > 0.0 ? along * along / (power * left) : 0.0;
  signature.rows = std::move(g);
  return signature;
}

Screens::Screens(const Contestant& null, const Levels& levels, std::size_t level) : here(null, levels[level], level) {
  if (level + 1 < levels.size() && null.Holds(level + 1)) next.emplace(null, levels[level + 1], level + 1);
  const std::size_t last = levels.free_run();
  if (last > level + 1 && null.Holds(last)) free.emplace(null, levels[last], last);
}

Sketch SketchOf(const Trial& candidate, const Screens& screens, const VectorXd& from) {
  Sketch sketch = candidate.effect->info().traits.harmonic ? HarmonicStart(candidate, screens.here, from)
                                                           : SizedStart(candidate, screens.here, from);
  if (sketch.removes != 0.0) {
    const auto look = [&](const Screen& screen) {
      const Signature signature = screen.Of(candidate.hypothesis, sketch.q);
      sketch.Saw(signature);
      sketch.removes = std::max(sketch.removes, signature.removes);
    };
    look(screens.here);
    if (screens.next) look(*screens.next);
  }
  // What a correction takes off at once may show in what it adds up to.
  if (sketch.IsSilent() && screens.free) {
    VectorXd q = from;
    q.segment(candidate.own(), candidate.starts.front().size()) = candidate.starts.front();
    sketch.Saw(screens.free->Of(candidate.hypothesis, q));
  }
  return sketch;
}

}  // namespace dynoproof::diagnosis
