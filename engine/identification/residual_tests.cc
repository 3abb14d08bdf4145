#include "identification/residual_tests.h"

#include <fmt/format.h>

#include <algorithm>
#include <boost/math/distributions/chi_squared.hpp>
#include <boost/math/distributions/fisher_f.hpp>
#include <cmath>
#include <limits>

#include "identification/noise_model.h"
#include "linear/dense.h"
#include "score/series.h"

namespace dynoproof::identification {
namespace {

constexpr int kOrder =
    30;  // of the noise's model: resonances of a drive line below 2 kHz at 10 kHz are some ten pole pairs

double FTail(double f, double m, double n) {
  if (!(f > 0.0) || n < 1.0) return 1.0;
  return boost::math::cdf(boost::math::complement(boost::math::fisher_f(m, n), f));
}

/// What noise cannot know, at the channel's own time stamps: held inputs, predicted outputs, and functions of them.
Eigen::MatrixXd Features(const EstimationProblem& problem, const ComparedOutput& channel,
                         const Eigen::VectorXd& predicted) {
  const auto& record = problem.records()[channel.record];
  const std::vector<double>& time = *record.outputs.at(channel.name).time;
  std::vector<Eigen::VectorXd> signals;
  for (const auto& [name, series] : record.inputs) {
    const std::vector<double> at = score::SampleAt({*series.time, *series.values, score::Interpolation::kHold}, time);
    signals.emplace_back(Eigen::Map<const Eigen::VectorXd>(at.data(), channel.count));
  }
  for (const ComparedOutput& other : problem.channels()) {
    if (other.record != channel.record || other.count != channel.count) continue;
    signals.emplace_back(predicted.segment(other.begin, other.count));
  }
  std::vector<Eigen::VectorXd> features;
  for (Eigen::VectorXd& signal : signals) {
    const double mean = signal.mean();
    const double scale = std::sqrt((signal.array() - mean).square().mean());
    if (!(scale > 1e-12 * (1.0 + std::abs(mean)))) continue;
    const Eigen::ArrayXd x = signal.array() / std::sqrt(signal.array().square().mean());
    features.emplace_back(x);
    features.emplace_back(x.square());
    features.emplace_back(x.abs());
    features.emplace_back(x.sign());
    features.emplace_back(x.cube());
  }
  Eigen::MatrixXd matrix(channel.count, static_cast<Eigen::Index>(features.size()));
  for (std::size_t k = 0; k < features.size(); ++k) matrix.col(static_cast<Eigen::Index>(k)) = features[k];
  return matrix;
}

}  // namespace

std::optional<double> LjungBoxPValue(const Eigen::VectorXd& w, int lags, int fitted) {
  const auto n = static_cast<double>(w.size());
  const double power = w.squaredNorm();
  if (!(power > 0.0) || lags <= fitted || w.size() < 4 * lags) return std::nullopt;
  double q = 0.0;
  for (int k = 1; k <= lags; ++k) {
    const double r = w.head(w.size() - k).dot(w.tail(w.size() - k)) / power;
    q += r * r / (n - k);
  }
  q *= n * (n + 2.0);
  return boost::math::cdf(boost::math::complement(boost::math::chi_squared(lags - fitted), q));
}

bool AnyFound(const std::vector<Structure>& structure) {
  return std::any_of(structure.begin(), structure.end(), [](const Structure& s) { return s.found(); });
}

std::string Structure::Text() const {
  std::vector<std::string> said;
  if (FollowsInputs())
    said.push_back(
        fmt::format("follows the inputs ({:.3g} % of its variance, F test p = {:.1g})", 100.0 * explained, p_value));
  if (HasLine())
    said.push_back(fmt::format("has a line at {:.4g} Hz ({:.3g} % of its variance, Fisher's g test p = {:.1g})",
                               line_hz, 100.0 * line_share, line_p_value));
  if (TooLarge())
    said.push_back(fmt::format(
        "is too large for noise (RMS {:.3g} times the level of its highest frequencies, variance {:.3g} times "
        "that of its one-step prediction error)",
        over_floor, rings));
  return said.empty() ? "" : fmt::format("{} {}", signal, fmt::join(said, " and "));
}

std::string TextOf(const std::vector<Structure>& structure) {
  std::vector<std::string> said;
  for (const Structure& one : structure) {
    if (one.found()) said.push_back(one.Text());
  }
  return fmt::format("{}", fmt::join(said, "; "));
}

std::vector<Structure> FindStructure(const EstimationProblem& problem, const Eigen::VectorXd& residual,
                                     const Eigen::VectorXd& predicted) {
  std::vector<Structure> found;
  constexpr int kPast[] = {0, 1, 2, 3, 4, 6, 8, 12};  // samples: what a resonance leaves after whitening is short
  for (const ComparedOutput& channel : problem.channels()) {
    Structure& result = found.emplace_back();
    result.signal = channel.name;
    const auto rows = residual.segment(channel.begin, channel.count);
    if (!rows.allFinite()) {  // nothing can be tested, and nothing is explained
      result.rings = result.over_floor = result.size = std::numeric_limits<double>::quiet_NaN();
      continue;
    }
    // A record without noise leaves the rounding of both simulations, which follows everything and means nothing.
    constexpr double kRounding = 1e-9;
    if (rows.norm() <= kRounding * channel.spread * std::sqrt(static_cast<double>(channel.count))) continue;
    const ArModel model = FitAr(rows, kOrder);
    const auto order = static_cast<Eigen::Index>(model.a.size());
    constexpr Eigen::Index kLag = 12;
    const Eigen::Index first = std::max(order, kLag), count = channel.count - first;
    if (count < 100) continue;
    result.tested = true;
    // Joint regression on the residual's own past and on the features: what the features add to the past is structure.
    const Eigen::MatrixXd features = Features(problem, channel, predicted);
    Eigen::MatrixXd past(count, order), other(count, features.cols() * static_cast<Eigen::Index>(std::size(kPast)) + 2);
    for (Eigen::Index k = 0; k < order; ++k) past.col(k) = rows.segment(first - 1 - k, count);
    Eigen::Index column = 0;
    for (Eigen::Index k = 0; k < features.cols(); ++k) {
      for (const int lag : kPast) other.col(column++) = features.col(k).segment(first - lag, count);
    }
    other.col(column++).setOnes();
    other.col(column++) = Eigen::VectorXd::LinSpaced(count, -1.0, 1.0);
    const Eigen::VectorXd target = rows.tail(count);
    const auto solve = [&](const Eigen::MatrixXd& x) -> Eigen::VectorXd {
      Eigen::MatrixXd gram = x.transpose() * x;
      const Eigen::VectorXd scale = gram.diagonal().array().max(1e-300).rsqrt();
      gram = scale.asDiagonal() * gram * scale.asDiagonal();
      gram.diagonal().array() += 1e-9;  // collinear features (an input never negative and its magnitude)
      const Eigen::VectorXd solution =
          scale.asDiagonal() * dense::SolveLdlt(gram, scale.asDiagonal() * (x.transpose() * target));
      return target - x * solution;
    };
    const Eigen::VectorXd alone = solve(past);
    Eigen::MatrixXd joint(count, past.cols() + other.cols());
    joint << past, other;
    const Eigen::VectorXd together = solve(joint);
    const double before = alone.squaredNorm(), after = together.squaredNorm();
    const auto m = static_cast<double>(other.cols()), n = static_cast<double>(count - joint.cols());
    if (before > 0.0 && after > 0.0) {
      result.explained = std::max(0.0, (1.0 - after / before) - m / static_cast<double>(count));
      result.p_value = FTail((before - after) / m / (after / n), m, n);
    }
    const std::vector<double> power = Periodogram(alone);
    const auto peak = std::max_element(power.begin(), power.end());
    double total = 0.0;
    for (const double value : power) total += value;
    if (peak != power.end() && total > 0.0) {
      const double g = *peak / total, bins = static_cast<double>(power.size());
      result.line_share = g;
      result.line_p_value = std::min(1.0, bins * std::exp((bins - 1.0) * std::log1p(-std::min(g, 1.0 - 1e-12))));
      result.line_hz = static_cast<double>(peak - power.begin() + 1) / (static_cast<double>(count) * channel.step_s);
    }
    constexpr int kFreeLags = 20;  // autocorrelations beyond those that the autoregressive model has fitted away
    result.ljung_box_p_value = LjungBoxPValue(alone, static_cast<int>(order) + kFreeLags, static_cast<int>(order));
    result.size = RmsOf(rows) / std::max(channel.spread, 1e-300);
    result.over_floor = RmsOf(rows) / std::max(HighFrequencyFloor(rows), 1e-300);
    const double variance = before / static_cast<double>(count);
    result.bursts = alone.array().square().square().mean() / std::max(variance * variance, 1e-300);
    result.rings = WithoutTrend(target).squaredNorm() / std::max(before, 1e-300);
  }
  return found;
}

ResidualTests TestsOf(const std::vector<Structure>& structure) {
  ResidualTests tests;
  const auto keep_least = [](std::optional<double>& least, const std::optional<double>& p) {
    if (p && (!least || *p < *least)) least = p;
  };
  for (const Structure& one : structure) {
    if (!one.tested) continue;
    keep_least(tests.ljung_box_p_value, one.ljung_box_p_value);
    keep_least(tests.regression_p_value, one.p_value);
    keep_least(tests.line_p_value, one.line_p_value);
  }
  return tests;
}

}  // namespace dynoproof::identification
