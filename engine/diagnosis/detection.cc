#include "diagnosis/detection.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "base/parallel.h"
#include "diagnosis/policy.h"
#include "linear/dense.h"

namespace dynoproof::diagnosis {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using estimation::Channel;
using estimation::ChannelScale;

/// Of the null's nominal values: what they cannot make up for.
class Remainder {
 public:
  Remainder(const Contestant& null, const Levels& levels)
      : levels_(levels), estimate_(null.levels[levels.free_run()]), jacobian_(estimate_.jacobian) {
    lower_ = null.hypothesis.lower() - estimate_.q;
    upper_ = null.hypothesis.upper() - estimate_.q;
    hessian_ = estimation::HessianOf(jacobian_, null.hypothesis);
  }

  /// Of weighted rows that an effect adds, what is left by the nominal values within their bounds: least squares, in which a
  /// value that would go beyond its bound stays there. `nominal`: the one that the effect itself changes, from its nominal
  /// value and not from its estimate; -1: none.
  VectorXd Of(const VectorXd& rows, Index nominal) const {
    const Index p = jacobian_.cols();
    VectorXd moved = VectorXd::Zero(p), lower = lower_, upper = upper_;
    if (p == 0) return rows;
    if (nominal >= 0) lower[nominal] += estimate_.q[nominal], upper[nominal] += estimate_.q[nominal];
    const VectorXd slope = jacobian_.transpose() * rows;
    std::vector<Index> free(static_cast<std::size_t>(p));
    for (Index i = 0; i < p; ++i) free[static_cast<std::size_t>(i)] = i;
    while (!free.empty()) {
      const VectorXd open = slope - hessian_ * moved;
      VectorXd step = dense::LeastSquares(hessian_(free, free), open(free));
      std::vector<Index> still;
      for (std::size_t k = 0; k < free.size(); ++k) {
        const Index i = free[k];
        const double to = moved[i] + step[static_cast<Index>(k)];
        if (to > lower[i] && to < upper[i])
          still.push_back(i);
        else
          moved[i] = std::clamp(to, lower[i], upper[i]);
      }
      if (still.size() == free.size()) {
        for (std::size_t k = 0; k < free.size(); ++k) moved[free[k]] += step[static_cast<Index>(k)];
        break;
      }
      free = std::move(still);
    }
    return rows - jacobian_ * moved;
  }

  /// Whether a remainder would have named its effect: a share of the excess that counts, and a weight of the null that is
  /// significantly below one.
  bool Shows(const VectorXd& left) const {
    double sum = 0.0;
    const auto& channels = levels_.data().channels();
    for (std::size_t c = 0; c < channels.size(); ++c) {
      const ChannelScale& scale = estimate_.scales[c];
      const auto rows = static_cast<double>(std::max<Index>(1, channels[c].count));
      const double seen = std::max(policy::kNoiseKnown, 2.0 * std::sqrt(2.0 * scale.correlation / rows));
      const double power = left.segment(channels[c].begin, channels[c].count).squaredNorm() * scale.correlation / rows;
      sum += std::log(std::max(power, seen) / seen);
    }
    return 1.0 - std::exp(-sum / static_cast<double>(channels.size())) >= policy::kShare &&
           left.norm() >= kSeenDeviations;
  }

 private:
  const Levels& levels_;
  const estimation::Estimate& estimate_;
  const MatrixXd& jacobian_;
  MatrixXd hessian_;
  VectorXd lower_, upper_;
};

/// How many times as large an effect has to be to show; nothing: at no size.
std::optional<double> SizeThatShows(const VectorXd& rows, const Remainder& remainder, Index nominal) {
  constexpr double kLeast = 1e-9, kMost = 1e6, kClose = 1.01;
  const auto shows = [&](double size) { return remainder.Shows(remainder.Of(size * rows, nominal)); };
  if (!rows.allFinite() || !shows(kMost)) return std::nullopt;
  double low = kLeast, high = kMost;
  while (high > kClose * low) {
    const double middle = std::sqrt(low * high);
    (shows(middle) ? high : low) = middle;
  }
  return high;
}

}  // namespace

double WithinItsPrior(const Trial& trial, const estimation::Hypothesis& null) {
  const Index nominal = NumberChanged(trial, null);
  if (nominal < 0) return 0.0;
  const estimation::Parameter& number = null.parameters()[static_cast<std::size_t>(nominal)];
  return number.upper / number.reference - 1.0;
}

std::vector<Seen> SmallestSeen(const Contestant& null, const Levels& levels, const Magnitudes& magnitudes,
                               const Registry& registry) {
  const std::size_t level = levels.free_run();
  if (!null.Holds(level)) return {};
  const estimation::Estimate& estimate = null.levels[level];
  const Remainder remainder(null, levels);
  const std::vector<Trial> trials = TrialsOf(null.hypothesis, levels, magnitudes, registry);
  std::vector<std::optional<Seen>> found(trials.size());
  ParallelFor(trials.size(), 0, [&](std::size_t k) {
    const Trial& trial = trials[k];
    if (trial.strengths.empty()) return;
    const VectorXd from = StartFrom(trial.hypothesis, null.hypothesis, estimate.q);
    const auto innovations = [&](double size) {
      VectorXd q = from;
      q.segment(trial.own(), trial.starts.front().size()) = trial.starts.front();
      for (const std::size_t i : trial.strengths) q[trial.own() + static_cast<Index>(i)] *= size;
      return levels[level].Innovations(trial.hypothesis.At(q));
    };
    const Index nominal = NumberChanged(trial, null.hypothesis);
    const Result<VectorXd> without = nominal >= 0 ? innovations(0.0) : Result<VectorXd>(estimate.innovations);
    // From the run at the size that has come out of the last one: few effects are linear over decades. What changes a nominal
    // value is followed by that one exactly, which a small change shows.
    constexpr double kSmall = 1e-2, kSame = 1.1;
    const int runs = nominal >= 0 ? 1 : 5;
    double size = nominal >= 0 ? kSmall : 1.0;
    for (int run = 0; run < runs; ++run) {
      const Result<VectorXd> with = innovations(size);
      if (!with.ok() || !without.ok()) return;
      VectorXd rows = *without - *with;
      WeighAs(estimate, levels.data(), rows);
      const std::optional<double> more = SizeThatShows(rows, remainder, nominal);
      if (!more) return;
      size *= *more;
      if (std::abs(std::log(*more)) < std::log(kSame)) break;
    }
    const std::size_t strength = trial.strengths.front();
    const estimation::Parameter& parameter =
        trial.hypothesis.parameters()[static_cast<std::size_t>(trial.own()) + strength];
    const double start = parameter.ValueAt(trial.starts.front()[static_cast<Index>(strength)]);
    const double neutral = trial.effect->info().parameters[strength].neutral;
    // A change of a number within its prior is no effect.
    const double smallest = std::max(size * std::abs(start - neutral), WithinItsPrior(trial, null.hypothesis));
    found[k] = Seen{trial.effect->info().name, trial.place.ToString(), parameter.unit, smallest};
  });
  std::vector<Seen> seen;
  for (std::optional<Seen>& one : found) {
    if (one) seen.push_back(*std::move(one));
  }
  return seen;
}

}  // namespace dynoproof::diagnosis
