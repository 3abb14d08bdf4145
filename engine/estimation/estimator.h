// Fits a hypothesis to a data set at one level of correction, or through the levels: the only continuation there is.
//
// Criterion at a point q, about a point q0 of the search:
//   Q(q) = sum_j n_j / tau_j (mean e_j^2(q) - N_j^2(q) + N_j^2(q0)) / s_j^2 + sum of the squared coordinates with a prior
// s_j: RMS of the innovations of channel j at q0; tau_j: their correlation time in rows, for errors that hang together count
// as often as they are independent; N_j: what measurement noise alone causes, which goes round the loop of the hypothesis:
// without it the least squares lie where the loop is quiet, not where the model is right. s, tau and q0 are renewed until Q
// settles.
#pragma once

#include <Eigen/Dense>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "estimation/hypothesis.h"
#include "estimation/predictor.h"

namespace dynoproof::estimation {

struct ChannelScale {
  double rms = 0.0;          // of the innovations
  double noise_alone = 0.0;  // what measurement noise alone causes
  double correlation = 1.0;  // integrated autocorrelation time, in rows
};

/// Estimate::termination where new columns promise less than asked for.
inline constexpr const char* kSettled = "settled";

/// Complete when it exists.
struct Estimate {
  Eigen::VectorXd q;                 // coordinates, by Hypothesis::parameters()
  Eigen::VectorXd innovations;       // by row of the data set
  Eigen::VectorXd weighted;          // innovations over scale and root of correlation time
  Eigen::MatrixXd jacobian;          // d weighted / d q
  Eigen::MatrixXd noise_slope;       // by channel: the noise's part of half the gradient of Q
  std::vector<ChannelScale> scales;  // by channel
  double criterion = 0.0;            // Q at q about q
  int iterations = 0, renewals = 0;
  std::int64_t simulations = 0;  // runs of a record, of this fit alone
  std::string termination;       // why it stopped
  std::string broken;            // why there is no estimate; empty: there is one

  bool ok() const { return broken.empty(); }
  /// Gives back the memory of all that has a row for each of the data's.
  void DropRows() {
    for (Eigen::VectorXd* rows : {&innovations, &weighted}) rows->resize(0);
    jacobian.resize(0, 0);
  }
};

/// Columns of the Jacobian that another fit at the same level has found, by the names of its parameters: a first look at a
/// hypothesis then costs one simulation for each number of its own.
struct KnownColumns {
  const Hypothesis* hypothesis;
  const Estimate* estimate;
};

struct EstimatorOptions {
  int iterations = 20;  // of Levenberg-Marquardt, between two renewals
  int renewals = 4;     // of s, tau, q0 and the columns of the Jacobian
  /// Points that a fit may look at; 0: as many as it likes. One that needs more goes along a valley.
  int points = 0;
  double converged = 1.0;  // what a step would still take off Q: an eighth of what decides between two models
  /// Or this share of what Q has beyond noise, if that is more: a model that is far off need not be found to the last digit.
  double of_excess = 0.0;
  /// The start is near by: a descent follows the columns of its beginning by what each step changes, a simulation a step. From
  /// afar they lead astray, so that each step gets its own.
  bool near = false;
  std::optional<KnownColumns> known = {};
  /// A descent does not end by a step of little gain, but where its columns promise little. Where numbers make up for each other, a step may
  /// cross a valley and end as high as it began, or stay within a radius that leaves nearly all that there is to gain.
  bool patient = false;
  /// Columns by central differences, for twice the simulations. The curvature that a difference to one side takes along stands
  /// at right angles to the columns of an oscillation, and is more than what numbers show that make up for each other.
  bool central = false;
};

/// Levenberg-Marquardt (Ceres) within the bounds, from `start` [parameters]. The fit ends where new columns promise less than
/// `converged`.
Estimate Fit(const Hypothesis& hypothesis, const Predictor& predictor, const Eigen::VectorXd& start,
             const EstimatorOptions& options = {});

/// Through the predictors in order, each from the estimate of the last one before that holds: a run may diverge beside its
/// record with one memory, and hold with the next. One estimate a predictor.
std::vector<Estimate> FitThrough(const Hypothesis& hypothesis, const std::vector<const Predictor*>& levels,
                                 const Eigen::VectorXd& start, const EstimatorOptions& options = {});

/// Curvature of half the criterion by the columns of a fit, J'J and 1 for each number with a prior [parameters x parameters].
Eigen::MatrixXd HessianOf(const Eigen::MatrixXd& jacobian, const Hypothesis& hypothesis);

/// Covariance of the coordinates by the sandwich H^-1 (sum_b g_b g_b') H^-1, g_b the gradient's part of block b of some 40
/// of each channel: errors that hang together count as such [parameters x parameters]. Empty where nothing is free.
Eigen::MatrixXd Sandwich(const Estimate& estimate, const DataSet& data, const Hypothesis& hypothesis);

/// Covariance by the curvature alone, H^-1 [parameters x parameters]: that of errors as large as the scales, where these
/// count as noise. Empty where nothing is free.
Eigen::MatrixXd CurvatureOf(const Estimate& estimate, const Hypothesis& hypothesis);

/// log likelihood of the innovations by the covariance that a level expects, over one row of each output on average; what
/// tells how much is unknown.
double LogLikelihood(const Estimate& estimate, const Predictor& predictor);

/// Scales of innovations at a model of which noise alone causes so much.
std::vector<ChannelScale> ScalesOf(const DataSet& data, const Eigen::VectorXd& innovations,
                                   const Eigen::VectorXd& noise_alone);

/// Integrated autocorrelation time 1 + 2 sum rho_k, until pairs of neighbours are not positive any more (Geyer 1992); at
/// least 1.
double CorrelationTime(const Eigen::Ref<const Eigen::VectorXd>& rows);

}  // namespace dynoproof::estimation
