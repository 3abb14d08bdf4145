#include "diagnosis/contestant.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "diagnosis/policy.h"
#include "linear/dense.h"

namespace dynoproof::diagnosis {
namespace {

using Eigen::Index;
using Eigen::VectorXd;
using estimation::Channel;
using estimation::ChannelScale;
using estimation::DataSet;
using estimation::Estimate;
using estimation::Hypothesis;

/// Standard error of a channel's power, of itself.
double PowerError(const ChannelScale& scale, const Channel& channel) {
  return std::sqrt(2.0 * scale.correlation / static_cast<double>(std::max<Index>(1, channel.count)));
}

}  // namespace

bool Refines(const Contestant& refined, const Contestant& plain) {
  if (refined.hypothesis.effects().empty() || plain.hypothesis.effects().empty()) return false;
  return refined.place() == plain.place() &&
         std::ranges::count(refined.effect().info().traits.refines, plain.effect().info().name) > 0;
}

double TimesNoise(const Estimate& estimate) {
  double largest = 0.0;
  for (const ChannelScale& scale : estimate.scales) largest = std::max(largest, scale.rms / scale.noise_alone);
  return largest;
}

Eigen::VectorXd NoiseAloneOf(const Estimate& estimate) {
  Eigen::VectorXd noise(std::ssize(estimate.scales));
  for (Eigen::Index c = 0; c < noise.size(); ++c) noise[c] = estimate.scales[static_cast<std::size_t>(c)].noise_alone;
  return noise;
}

bool IsExact(const std::vector<ChannelScale>& scales) {
  return std::ranges::all_of(
      scales, [](const ChannelScale& scale) { return scale.rms <= policy::kNoiseSize * scale.noise_alone; });
}

bool IsExact(const Estimate& estimate) { return IsExact(estimate.scales); }

bool IsNearTheNoise(const Estimate& estimate) {
  constexpr double kNear = 3.0;
  return std::ranges::all_of(estimate.scales,
                             [](const ChannelScale& one) { return one.rms <= kNear * one.noise_alone; });
}

bool IsQuiet(const Estimate& estimate, const DataSet& data) {
  for (std::size_t c = 0; c < estimate.scales.size(); ++c) {
    if (estimate.scales[c].noise_alone > policy::kQuiet * data.channels()[c].noise) return false;
  }
  return true;
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

void WeighAs(const Estimate& estimate, const DataSet& data, VectorXd& rows) {
  for (std::size_t c = 0; c < data.channels().size(); ++c) {
    const Channel& channel = data.channels()[c];
    rows.segment(channel.begin, channel.count) /= estimate.scales[c].rms * std::sqrt(estimate.scales[c].correlation);
  }
}

double LogLeft(const Estimate& fit, const Levels& levels) { return LogExcess(fit.scales, levels.data()); }

double ShareOf(const Contestant& contestant, const Contestant& null, const Levels& levels, std::size_t level) {
  return 1.0 - std::exp(LogLeft(contestant.levels[level], levels) - LogLeft(null.levels[level], levels));
}

double LogLeftAt(const VectorXd& q, const Hypothesis& model, const Levels& levels, std::size_t level) {
  const Result<estimation::Prediction> there = levels[level].Predict(model.At(q));
  if (!there.ok()) return std::numeric_limits<double>::infinity();
  return LogExcess(estimation::ScalesOf(levels.data(), there->innovations, there->noise_alone), levels.data());
}

const Contestant* LeaderAt(std::span<const Contestant> contestants, const Levels& levels, std::size_t level) {
  const Contestant* leader = nullptr;
  for (const Contestant& one : contestants) {
    if (one.Holds(level) &&
        (leader == nullptr || LogLeft(one.levels[level], levels) < LogLeft(leader->levels[level], levels)))
      leader = &one;
  }
  return leader;
}

bool NamesSomething(const Contestant& one, std::size_t level) {
  constexpr double kThere = 1e-6, kNearTheUpper = 1e-3;  // coordinates: 1 is a start's size
  if (!one.Holds(level)) return false;
  const VectorXd lower = one.hypothesis.lower(), upper = one.hypothesis.upper();
  const auto end = static_cast<Index>(one.hypothesis.of_effects());
  const auto count = static_cast<Index>(one.effect().info().parameters.size());
  bool acts = count == 0;
  for (Index i = end - count; i < end; ++i) {
    const estimation::Parameter& parameter = one.hypothesis.parameters()[static_cast<std::size_t>(i)];
    const double q = one.levels[level].q[i];
    const bool bound = q < lower[i] + kThere || q > upper[i] - std::min(kNearTheUpper, upper[i] - lower[i]);
    const bool neutral = parameter.neutral && std::abs(q - parameter.CoordinateOf(*parameter.neutral)) < kThere;
    if (bound && !neutral) return false;
    acts = acts || !neutral;
  }
  return acts;
}

double OffNominal(const Contestant& one, std::size_t level) {
  double sum = 0.0;
  for (std::size_t i = 0; i < one.hypothesis.parameters().size(); ++i) {
    if (one.hypothesis.parameters()[i].prior) sum += std::pow(one.levels[level].q[static_cast<Index>(i)], 2);
  }
  return sum;
}

bool Shows(const Estimate& fit, std::size_t number) {
  return fit.jacobian.rows() == 0 || fit.jacobian.col(static_cast<Index>(number)).squaredNorm() > 1.0;
}

std::vector<std::size_t> NominalValuesOnBounds(const Contestant& one, std::size_t level) {
  constexpr double kThere = 1e-6;  // coordinates: 1 is a standard deviation, or the factor e
  const VectorXd lower = one.hypothesis.lower(), upper = one.hypothesis.upper();
  const Estimate& fit = one.levels[level];
  std::vector<std::size_t> on_bounds;
  for (auto i = static_cast<Index>(one.hypothesis.of_effects()); i < lower.size(); ++i) {
    if (Shows(fit, static_cast<std::size_t>(i)) && (fit.q[i] < lower[i] + kThere || fit.q[i] > upper[i] - kThere))
      on_bounds.push_back(static_cast<std::size_t>(i));
  }
  return on_bounds;
}

std::vector<Idle> IdleEffects(const Contestant& one, std::size_t level) {
  const Estimate& fit = one.levels[level];
  std::vector<Idle> idle;
  Index begin = 0;
  for (std::size_t k = 0; k < one.hypothesis.effects().size(); ++k) {
    const auto count = static_cast<Index>(one.hypothesis.effects()[k].effect->info().parameters.size());
    VectorXd acts(count);
    for (Index i = 0; i < count; ++i) {
      const estimation::Parameter& parameter = one.hypothesis.parameters()[static_cast<std::size_t>(begin + i)];
      acts[i] = fit.q[begin + i] - (parameter.neutral ? parameter.CoordinateOf(*parameter.neutral)
                                                      : std::numeric_limits<double>::infinity());
    }
    if (count > 0 && acts.allFinite()) {
      const VectorXd along = fit.jacobian.middleCols(begin, count) * acts;
      Eigen::MatrixXd others = fit.jacobian;
      others.middleCols(begin, count).setZero();
      const VectorXd follow =
          dense::LeastSquares(estimation::HessianOf(others, one.hypothesis), others.transpose() * along);
      if (along.dot(along - others * follow) < policy::kByChance) {
        idle.push_back({k, fit.q + follow});
        idle.back().q.segment(begin, count) -= acts;
      }
    }
    begin += count;
  }
  return idle;
}

VectorXd StartFrom(const Hypothesis& hypothesis, const Hypothesis& other, const VectorXd& q) {
  return StartFrom(hypothesis, other, q, hypothesis.start());
}

VectorXd StartFrom(const Hypothesis& hypothesis, const Hypothesis& other, const VectorXd& q, VectorXd start) {
  for (std::size_t i = 0; i < hypothesis.parameters().size(); ++i) {
    const auto same =
        std::ranges::find(other.parameters(), hypothesis.parameters()[i].name, &estimation::Parameter::name);
    if (same != other.parameters().end()) start[static_cast<Index>(i)] = q[same - other.parameters().begin()];
  }
  return start;
}

int PointsFor(const Hypothesis& hypothesis) {
  return policy::kSteps + policy::kColumns * (1 + static_cast<int>(hypothesis.parameters().size()));
}

Estimate AsLoudAs(const Contestant& null, std::size_t level, Estimate estimate) {
  if (!estimate.ok() || !null.Holds(level)) return estimate;
  for (std::size_t c = 0; c < estimate.scales.size(); ++c) {
    double& own = estimate.scales[c].noise_alone;
    const double of_null = null.levels[level].scales[c].noise_alone;
    own = null.coloured ? std::max(own, of_null) : std::min(own, of_null);
  }
  return estimate;
}

void CountAsNoise(Contestant one, std::span<Contestant> all) {
  for (Contestant& other : all) {
    other.coloured = true;
    for (std::size_t level = 0; level < other.levels.size(); ++level) {
      if (!one.Holds(level) || !other.Holds(level)) continue;
      for (std::size_t c = 0; c < one.levels[level].scales.size(); ++c) {
        double& noise = other.levels[level].scales[c].noise_alone;
        noise = std::max(noise, one.levels[level].scales[c].rms);
      }
    }
  }
}

}  // namespace dynoproof::diagnosis
