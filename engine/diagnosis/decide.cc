#include "diagnosis/decide.h"

#include <algorithm>
#include <boost/math/distributions/fisher_f.hpp>
#include <cmath>

#include "diagnosis/policy.h"
#include "linear/dense.h"

namespace dynoproof::diagnosis {

std::vector<double> CrossValidate(const EstimationProblem& problem, const Estimator& estimator, const Estimate& fit) {
  const Eigen::VectorXd white = estimator.whitener()(problem.measured() - fit.predicted);
  // The state a record starts from shows in its first part only: no other part could tell it, so it stays.
  std::vector<Eigen::Index> columns;
  std::vector<double> prior;
  const auto effects = fit.jacobian.cols() - static_cast<Eigen::Index>(fit.nuisances.free.size());
  for (Eigen::Index k = 0; k < fit.jacobian.cols(); ++k) {
    if (k < effects) {
      columns.push_back(k), prior.push_back(0.0);
      continue;
    }
    const auto nuisance = static_cast<std::size_t>(fit.nuisances.free[static_cast<std::size_t>(k - effects)]);
    if (problem.nuisances()[nuisance].start) continue;
    columns.push_back(k), prior.push_back(1.0 / std::pow(fit.nuisances.freedom[nuisance], 2));
  }
  const auto p = static_cast<Eigen::Index>(columns.size());
  Eigen::MatrixXd jacobian(fit.jacobian.rows(), p);
  for (Eigen::Index k = 0; k < p; ++k) jacobian.col(k) = fit.jacobian.col(columns[static_cast<std::size_t>(k)]);
  Eigen::MatrixXd information = jacobian.transpose() * jacobian;
  for (Eigen::Index k = 0; k < p; ++k) information(k, k) += prior[static_cast<std::size_t>(k)];
  std::vector<double> blocks(policy::kBlocks, 0.0);
  for (int b = 0; b < policy::kBlocks; ++b) {
    Eigen::MatrixXd inside = Eigen::MatrixXd::Zero(p, p);
    Eigen::VectorXd right = Eigen::VectorXd::Zero(p);
    const auto each = [&](const auto& visit) {
      for (const Channel& channel : problem.channels()) {
        const Eigen::Index begin = channel.begin + channel.count * b / policy::kBlocks;
        visit(begin, channel.begin + channel.count * (b + 1) / policy::kBlocks - begin);
      }
    };
    each([&](Eigen::Index begin, Eigen::Index count) {
      const auto rows = jacobian.middleRows(begin, count);
      inside += rows.transpose() * rows;
      right += rows.transpose() * white.segment(begin, count);
    });
    // What this part alone can tell, the others cannot foretell, and need not: it is known to ten of its deviations.
    constexpr double kKnown = 0.01;
    const Eigen::MatrixXd outside = information - (1.0 - kKnown) * inside;
    const Eigen::VectorXd scale = outside.diagonal().array().max(1e-300).rsqrt();
    Eigen::MatrixXd scaled = scale.asDiagonal() * outside * scale.asDiagonal();
    scaled.diagonal().array() += 1e-10;
    const Eigen::VectorXd shift =
        p > 0 ? Eigen::VectorXd(scale.asDiagonal() * dense::SolveLdlt(scaled, scale.asDiagonal() * right)) : right;
    each([&](Eigen::Index begin, Eigen::Index count) {
      Eigen::VectorXd error = white.segment(begin, count);
      if (p > 0) error += jacobian.middleRows(begin, count) * shift;
      blocks[static_cast<std::size_t>(b)] += error.squaredNorm();
    });
  }
  return blocks;
}

double Threshold(double rows, std::size_t candidates) {
  const double odds = 2.0 * std::log(policy::kOdds * static_cast<double>(std::max<std::size_t>(1, candidates)));
  return std::max(odds + std::log(std::max(2.0, rows)), policy::kLeastShare * rows);
}

Standing Compare(const EstimationProblem& problem, const Estimate& nominal, const std::vector<double>& nominal_blocks,
                 const Estimate& fit, const std::vector<double>& blocks, double rows, std::size_t candidates) {
  Standing standing;
  standing.chi2_gain = nominal.chi2 - fit.chi2;
  standing.criterion_gain = nominal.criterion - fit.criterion;
  const auto p = static_cast<double>(std::max(1, fit.parameters()));
  const double left = rows - p;
  if (standing.chi2_gain > 0.0 && left > 1.0 && fit.chi2 > 0.0) {
    const double f = standing.chi2_gain / p / (fit.chi2 / left);
    const double tail = boost::math::cdf(boost::math::complement(boost::math::fisher_f(p, left), f));
    standing.p_value = std::min(1.0, tail * static_cast<double>(candidates));
  }
  for (std::size_t b = 0; b < blocks.size(); ++b) {
    standing.validation_gain += nominal_blocks[b] - blocks[b];
    standing.validation_chi2 += blocks[b];
    standing.blocks_better += blocks[b] < nominal_blocks[b] ? 1 : 0;
  }
  const double threshold = Threshold(rows, candidates);
  // A nominal model that needs its nuisance parameters far outside their spread predicts the validation parts as well
  // as an effect that says so openly; then it is enough that the effect is not worse there.
  const bool valid = LargestDeviation(problem, nominal) > policy::kWithinPrior
                         ? standing.validation_gain > -0.5 * threshold
                         : standing.validation_gain > 0.0 && standing.blocks_better >= policy::kBlocksBetter;
  standing.significant =
      standing.chi2_gain > threshold && standing.criterion_gain > policy::kCriterionShare * threshold && valid;
  return standing;
}

bool LeavesTheSignal(const EstimationProblem& problem, const Estimate& null, const Estimate& best) {
  constexpr double kMost = 0.5;
  double most = 0.0;
  bool leaves = false;
  for (const Channel& c : problem.channels()) {
    const auto rms = [&](const Estimate& fit) {
      return RmsOf(problem.measured().segment(c.begin, c.count) - fit.predicted.segment(c.begin, c.count));
    };
    const double before = rms(null), after = rms(best);
    const double gain = static_cast<double>(c.count) * (before * before / std::max(after * after, 1e-300) - 1.0);
    if (!std::isfinite(after)) return true;
    if (gain <= most) continue;
    most = gain;
    leaves = after > kMost * before && after > kMost * c.spread;
  }
  return leaves;
}

std::vector<std::size_t> AmbiguitySet(const std::vector<Estimate>& fits, double threshold) {
  std::vector<std::size_t> set;
  for (std::size_t i = 0; i < fits.size(); ++i) {
    if (fits[i].criterion - fits[0].criterion > policy::kAlike) continue;
    bool needless = false;
    for (const std::size_t j : set)
      needless = needless || (fits[i].parameters() > fits[j].parameters() && fits[j].chi2 - fits[i].chi2 < threshold &&
                              fits[i].hypothesis.effects.back().place == fits[j].hypothesis.effects.back().place);
    if (!needless) set.push_back(i);
  }
  return set;
}

bool GainsOnHoldout(const HoldoutErrors& errors, double deviation) {
  const bool rival = !(deviation > policy::kWithinPrior);
  return errors.after < errors.before && (!rival || errors.after < errors.released);
}

}  // namespace dynoproof::diagnosis
