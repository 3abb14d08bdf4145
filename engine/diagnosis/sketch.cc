#include "diagnosis/sketch.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "diagnosis/policy.h"
#include "linear/dense.h"

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
    const Signature signature = screen.Of(candidate, q);
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
    const Signature sine = screen.Of(candidate, q);
    q[own + 2] = phase.CoordinateOf(0.5 * std::numbers::pi);
    const Signature cosine = screen.Of(candidate, q);
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

double SquaresOf(const Contestant& one, std::size_t level) {
  return one.levels[level].weighted.squaredNorm() + OffNominal(one, level);
}

Screen::Screen(const Contestant& null, const estimation::Predictor& predictor, std::size_t level)
    : null_(null),
      predictor_(predictor),
      estimate_(null.levels[level]),
      inverse_(estimation::CurvatureOf(estimate_, null.hypothesis)),
      off_(estimate_.q) {
  for (Index i = 0; i < off_.size(); ++i) {
    if (!null.hypothesis.parameters()[static_cast<std::size_t>(i)].prior) off_[i] = 0.0;
  }
}

MatrixXd Screen::InverseBeside(const Trial& candidate) const {
  const Index own = NumberChanged(candidate, null_.hypothesis);
  if (own < 0 || estimate_.jacobian.cols() == 0) return inverse_;
  MatrixXd curvature = estimation::HessianOf(estimate_.jacobian, null_.hypothesis);
  curvature.row(own).setZero();
  curvature.col(own).setZero();
  return dense::PseudoInverse(curvature);
}

Signature Screen::Of(const Trial& candidate, const VectorXd& q) const {
  const Result<VectorXd> with = predictor_.Innovations(candidate.hypothesis.At(q));
  if (!with.ok()) return {};
  Signature signature;
  signature.ran = true;
  signature.change = estimate_.innovations - *with;
  for (std::size_t c = 0; c < estimate_.scales.size(); ++c) {
    const estimation::Channel& channel = predictor_.data().channels()[c];
    const double rms = signature.change.segment(channel.begin, channel.count).norm() /
                       std::sqrt(std::max(1.0, static_cast<double>(channel.count)));
    signature.moves = std::max(signature.moves, rms / estimate_.scales[c].noise_alone);
  }
  WeighAs(estimate_, predictor_.data(), signature.change);
  const MatrixXd& J = estimate_.jacobian;
  signature.rest = signature.change;
  double along = signature.change.dot(estimate_.weighted), own_off = 0.0;
  if (J.cols() > 0) {
    const VectorXd follow = InverseBeside(candidate) * (J.transpose() * signature.change);
    signature.rest -= J * follow;
    along -= follow.dot(J.transpose() * estimate_.weighted + off_);
    if (const Index own = NumberChanged(candidate, null_.hypothesis); own >= 0) own_off = off_[own];
  }
  const double power = signature.rest.dot(signature.change);
  if (!(power > 0.0)) return signature;
  signature.size = along / power;
  const double left = estimate_.weighted.squaredNorm() + off_.squaredNorm();
  signature.removes = left > 0.0 ? (along * along / power + own_off * own_off) / left : 0.0;
  return signature;
}

double Screen::Removed(const Trial& candidate, const VectorXd& q, const Signature& signature) const {
  const double left = estimate_.weighted.squaredNorm();
  if (!(left > 0.0) || !signature.ran) return 0.0;
  double removed = 1.0 - (estimate_.weighted - signature.change).squaredNorm() / left;
  if (estimate_.jacobian.cols() == 0) return std::max(0.0, removed);
  Result<VectorXd> run = predictor_.Innovations(candidate.hypothesis.At(Followed(candidate, q, signature)));
  if (run.ok()) {
    WeighAs(estimate_, predictor_.data(), *run);
    removed = std::max(removed, 1.0 - run->squaredNorm() / left);
  }
  return std::max(0.0, removed);
}

VectorXd Screen::Followed(const Trial& candidate, const VectorXd& q, const Signature& signature) const {
  const MatrixXd& J = estimate_.jacobian;
  if (J.cols() == 0 || !signature.ran) return q;
  const VectorXd there = estimate_.weighted - signature.change;
  VectorXd follows = estimate_.q - InverseBeside(candidate) * (J.transpose() * there + off_);
  follows = follows.cwiseMax(null_.hypothesis.lower()).cwiseMin(null_.hypothesis.upper());
  VectorXd moved = StartFrom(candidate.hypothesis, null_.hypothesis, follows);
  const auto count = static_cast<Index>(candidate.effect->info().parameters.size());
  moved.segment(candidate.own(), count) = q.segment(candidate.own(), count);
  return moved;
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
      const Signature signature = screen.Of(candidate, sketch.q);
      sketch.Saw(signature);
      sketch.removes = std::max(sketch.removes, signature.removes);
      return signature.removes;
    };
    look(screens.here);
    if (screens.next) sketch.next = look(*screens.next);
  }
  // A force that a correction takes off at once may show in the free run, where it adds up.
  if (sketch.IsSilent() && screens.free) {
    VectorXd q = from;
    q.segment(candidate.own(), candidate.starts.front().size()) = candidate.starts.front();
    sketch.Saw(screens.free->Of(candidate, q));
  }
  return sketch;
}

}  // namespace dynoproof::diagnosis
