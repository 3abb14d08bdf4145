#include "estimation/encompassing.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "experiment/drive_by_record.h"
#include "linear/dense.h"

namespace dynoproof::estimation {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {

/// The parameters that are not where a record starts.
std::vector<Index> WithoutStarts(const Hypothesis& hypothesis) {
  std::vector<Index> others;
  for (std::size_t i = 0; i < hypothesis.parameters().size(); ++i) {
    if (!IsOfAStart(hypothesis.parameters()[i].name)) others.push_back(static_cast<Index>(i));
  }
  return others;
}

}  // namespace

VectorXd LeaveBlocksOut(const Estimate& estimate, const DataSet& data, const Hypothesis& hypothesis) {
  const std::vector<Index> moved = WithoutStarts(hypothesis);
  VectorXd left = estimate.weighted;
  if (estimate.jacobian.cols() == 0 || moved.empty()) return estimate.innovations;
  const MatrixXd J = estimate.jacobian(Eigen::all, moved), H = HessianOf(estimate.jacobian, hypothesis)(moved, moved);
  for (const Block& block : BlocksOf(data)) {
    MatrixXd others = H;
    VectorXd score = VectorXd::Zero(H.rows());
    for (const Block::Rows& rows : block.rows) {
      others -= J.middleRows(rows.begin, rows.count).transpose() * J.middleRows(rows.begin, rows.count);
      score += J.middleRows(rows.begin, rows.count).transpose() * estimate.weighted.segment(rows.begin, rows.count);
    }
    const VectorXd step = dense::LeastSquares(others, score);
    for (const Block::Rows& rows : block.rows)
      left.segment(rows.begin, rows.count) += J.middleRows(rows.begin, rows.count) * step;
  }
  for (std::size_t c = 0; c < data.channels().size(); ++c) {
    const Channel& channel = data.channels()[c];
    left.segment(channel.begin, channel.count) *= estimate.scales[c].rms * std::sqrt(estimate.scales[c].correlation);
  }
  return left;
}

VectorXd WeightsByChannel(const DataSet& data, const std::vector<ChannelScale>& scales) {
  VectorXd weights(data.measured().size());
  for (std::size_t c = 0; c < data.channels().size(); ++c) {
    const Channel& channel = data.channels()[c];
    weights.segment(channel.begin, channel.count)
        .setConstant(1.0 / (scales[c].rms * scales[c].rms * scales[c].correlation));
  }
  return weights;
}

VectorXd WeightsByBlock(std::span<const VectorXd> innovations, const DataSet& data,
                        const std::vector<ChannelScale>& scales) {
  VectorXd weights(data.measured().size());
  for (const Block& block : BlocksOf(data)) {
    for (const auto& [c, begin, count] : block.rows) {
      if (count == 0) continue;
      double least = std::numeric_limits<double>::infinity();
      for (const VectorXd& left : innovations) {
        if (left.size() > 0)
          least = std::min(least, left.segment(begin, count).squaredNorm() / static_cast<double>(count));
      }
      const double power = std::max(least, std::pow(data.channels()[c].noise, 2));
      weights.segment(begin, count).setConstant(1.0 / (power * scales[c].correlation));
    }
  }
  return weights;
}

Weight Encompassing(const VectorXd& a, const VectorXd& b, const DataSet& data, const VectorXd& w) {
  // Innovations smaller than the measurement noise come from the course of an input between its samples, or from round-off. They
  // are systematic, so that sums over blocks understate the standard error.
  VectorXd least(a.size());
  for (const Channel& channel : data.channels()) least.segment(channel.begin, channel.count).setConstant(channel.noise);
  const VectorXd d = a - b, wd = w.cwiseProduct(d);
  const double power = wd.dot(d);
  if (!(power > 0.0)) return {0.5, std::numeric_limits<double>::infinity()};
  Weight result{wd.dot(a) / power, 0.0};
  const VectorXd v = a - result.lambda * d;
  double by_block = 0.0;
  for (const Block& block : BlocksOf(data)) {
    double sum = 0.0;
    for (const Block::Rows& rows : block.rows)
      sum += wd.segment(rows.begin, rows.count).dot(v.segment(rows.begin, rows.count));
    by_block += sum * sum;
  }
  const double by_row = wd.cwiseProduct(v).squaredNorm(), by_noise = wd.cwiseProduct(least).squaredNorm();
  result.standard_error = std::sqrt(std::max({by_block, by_row, by_noise})) / power;
  return result;
}

Comparison Compare(const Weight& weight) {
  constexpr double kNothing = 0.3, kAlmost = 0.9, kSure = 4.0, kLikely = 3.0;
  const double lambda = weight.lambda, error = weight.standard_error;
  if (lambda < kNothing && lambda + kSure * error < kAlmost) return Comparison::kFirst;
  if (1.0 - lambda < kNothing && 1.0 - lambda + kSure * error < kAlmost) return Comparison::kSecond;
  if (lambda - kLikely * error > 1.0 - kAlmost && lambda + kLikely * error < kAlmost) return Comparison::kBoth;
  return Comparison::kNotSeparable;
}

}  // namespace dynoproof::estimation
