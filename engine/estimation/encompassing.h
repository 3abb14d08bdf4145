// Which of two fitted models predicts what the other does not: the weight of the second in the best mixture of both.
#pragma once

#include <Eigen/Dense>
#include <span>

#include "estimation/estimator.h"

namespace dynoproof::estimation {

/// Innovations of each block of rows (BlocksOf) by the estimate that the other blocks give: one Newton step, exact for a
/// linear least squares, e_b + J_b (H - J_b'J_b)^-1 J_b'e_b with H the curvature of all (priors included). Where a record starts stays as
/// fitted: its first block tells that and no other, which would judge a model by a start that nobody knows.
Eigen::VectorXd LeaveBlocksOut(const Estimate& estimate, const DataSet& data, const Hypothesis& hypothesis);

struct Weight {
  double lambda = 0.5, standard_error = 0.0;
};

/// What rows count in a comparison of models, 1 / (s^2 tau), by the `scales` of a channel: s the RMS that a model leaves there, tau the
/// correlation time.
Eigen::VectorXd WeightsByChannel(const DataSet& data, const std::vector<ChannelScale>& scales);
/// The same with s by block of time: what the best of the models leaves of the channel there, and at least its noise. Where a model leaves
/// nothing but noise, an impact that none of them meets counts no more than any other block does. `innovations`: of each model by row,
/// or empty.
Eigen::VectorXd WeightsByBlock(std::span<const Eigen::VectorXd> innovations, const DataSet& data,
                               const std::vector<ChannelScale>& scales);

/// lambda = sum w e_a d / sum w d^2, d = e_a - e_b: the weight of b in the mixture of the two predictions that leaves
/// least (Davidson, MacKinnon 1981; Harvey, Leybourne, Newbold 1998). `a`, `b`: innovations by row; `w`: what rows count. The
/// standard error is that of sums over blocks, at least that of single rows, and at
/// least what the noise would make of it. Where both predict the same it is infinite.
Weight Encompassing(const Eigen::VectorXd& a, const Eigen::VectorXd& b, const DataSet& data, const Eigen::VectorXd& w);

enum class Comparison { kFirst, kSecond, kBoth, kNotSeparable };
/// By size and significance together: the first wins where the second adds nothing that counts (lambda below 0.3, and four
/// standard errors from 0.9); both are needed where lambda is three from 0.1 and from 0.9.
Comparison Compare(const Weight& weight);

}  // namespace dynoproof::estimation
