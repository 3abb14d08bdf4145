#include "estimation/estimator.h"

#include <ceres/ceres.h>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include "linear/dense.h"

namespace dynoproof::estimation {
namespace {

using Eigen::Index;
using Eigen::VectorXd;
using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

constexpr double kLoudest = 2.0;        // times the noise alone of the start: a louder loop is no model any more
constexpr double kNextToNothing = 0.1;  // of what a fit asks for: its next columns tell whether there is more
constexpr double kStraight = 1e3;       // rows of a channel: the constant beside the noise's part
constexpr double kSettledScale = 0.1;   // change of s at which a renewal may be the last
constexpr double kCentralStep = 1e-4;   // 1e-6 of a stiffness known to 1 %: a mode turns by 1e-3 rad in 500 periods

/// One simulated point.
struct Point {
  VectorXd q, innovations, noise_alone;
  bool rough = false;
};

/// The coordinates on a bound that a descent would leave by it: beside them the others find their minimum.
std::vector<Index> HeldByBounds(const VectorXd& gradient, const VectorXd& q, const VectorXd& lower,
                                const VectorXd& upper) {
  std::vector<Index> held;
  for (Index i = 0; i < q.size(); ++i) {
    if ((q[i] <= lower[i] && gradient[i] > 0.0) || (q[i] >= upper[i] && gradient[i] < 0.0)) held.push_back(i);
  }
  return held;
}

/// The decrease of the criterion that a Gauss-Newton step within the bounds promises (Newton decrement).
double DecrementOf(const RowMajor& columns, const VectorXd& weighted, const VectorXd& q, const VectorXd& lower,
                   const VectorXd& upper) {
  const VectorXd gradient = columns.transpose() * weighted;
  const std::vector<Index> held = HeldByBounds(gradient, q, lower, upper);
  std::vector<Index> free;
  for (Index i = 0; i < q.size(); ++i) {
    if (std::ranges::find(held, i) == held.end()) free.push_back(i);
  }
  if (free.empty()) return 0.0;
  Eigen::MatrixXd curvature = Eigen::MatrixXd::Zero(q.size(), q.size());
  curvature.selfadjointView<Eigen::Lower>().rankUpdate(columns.transpose());
  curvature.triangularView<Eigen::StrictlyUpper>() = curvature.transpose();
  const VectorXd slope = gradient(free);
  return slope.dot(dense::LeastSquares(curvature(free, free), slope));
}

class Residual : public ceres::CostFunction {
 public:
  Residual(const Hypothesis& hypothesis, const Predictor& predictor, const EstimatorOptions& options)
      : hypothesis_(hypothesis),
        predictor_(predictor),
        known_(options.known),
        central_(options.central),
        near_(options.near) {
    rows_ = predictor.data().measured().size();
    for (std::size_t i = 0; i < hypothesis.parameters().size(); ++i) {
      if (hypothesis.parameters()[i].prior) priors_.push_back(static_cast<Index>(i));
    }
    set_num_residuals(static_cast<int>(rows_ + std::ssize(predictor.data().channels()) + std::ssize(priors_)));
    mutable_parameter_block_sizes()->push_back(static_cast<int>(hypothesis.parameters().size()));
  }

  /// Simulates, or gives what was simulated last.
  std::optional<Point> At(const VectorXd& q) const {
    if (last_ && last_->q == q) return last_;
    ++points_;
    Result<Prediction> prediction = predictor_.Predict(hypothesis_.At(q));
    if (!prediction.ok()) {
      broken_ = prediction.failure().ToString();
      return std::nullopt;
    }
    last_ = Point{q, std::move(prediction->innovations), std::move(prediction->noise_alone), prediction->rough};
    return last_;
  }

  /// Weighs by the scales at this point from now on.
  void About(const Point& point) {
    about_ = point;
    scales_ = ScalesOf(predictor_.data(), point.innovations, point.noise_alone);
  }

  /// Innovations over scales, by row; then the noise's part, by channel; then the coordinates with a prior.
  VectorXd Weighted(const Point& point) const {
    VectorXd rows(num_residuals());
    for (std::size_t c = 0; c < scales_.size(); ++c) {
      const Channel& channel = predictor_.data().channels()[c];
      const auto k = static_cast<Index>(c);
      const double power = std::pow(scales_[c].rms, 2), about = std::pow(about_.noise_alone[k], 2);
      rows.segment(channel.begin, channel.count) =
          point.innovations.segment(channel.begin, channel.count) / std::sqrt(scales_[c].correlation * power);
      // What the noise adds to the squares is taken off them: as the square of a root, for least squares know nothing else,
      // and beside a constant so large that the root is straight and its slope no part of the curvature.
      // Noise is known to some hundredths. Where less is left than it should cause, it is that much smaller.
      const double count = static_cast<double>(channel.count) / scales_[c].correlation;
      const double more = (std::pow(point.noise_alone[k], 2) - about) * std::min(1.0, power / about) / power;
      rows[rows_ + k] = std::sqrt(count * std::max(kStraight - more, 0.0));
    }
    for (std::size_t i = 0; i < priors_.size(); ++i)
      rows[rows_ + std::ssize(scales_) + static_cast<Index>(i)] = point.q[priors_[i]];
    return rows;
  }

  /// Q itself, of weighted residuals about the point of the scales.
  double CriterionOf(const VectorXd& weighted) const {
    double constant = 0.0;
    for (std::size_t c = 0; c < scales_.size(); ++c)
      constant += kStraight * static_cast<double>(predictor_.data().channels()[c].count) / scales_[c].correlation;
    return weighted.squaredNorm() - constant;
  }

  bool Evaluate(double const* const* parameters, double* residuals, double** jacobians) const override {
    const VectorXd q = Eigen::Map<const VectorXd>(parameters[0], std::ssize(hypothesis_.parameters()));
    const std::optional<Point> here = At(q);
    if (!here || (here->noise_alone.array() > kLoudest * about_.noise_alone.array()).any() ||
        !here->noise_alone.allFinite())
      return false;
    const VectorXd weighted = Weighted(*here);
    std::copy(weighted.begin(), weighted.end(), residuals);
    if (jacobians == nullptr || jacobians[0] == nullptr) return true;
    Eigen::Map<RowMajor> jacobian(jacobians[0], weighted.size(), q.size());
    if (kept_.size() > 0) {
      Follow(q, weighted);
      jacobian = kept_;
    } else {
      const std::optional<RowMajor> columns = ColumnsAt(*here, weighted);
      if (!columns) return false;
      jacobian = *columns;
    }
    if (near_) promised_ = DecrementOf(jacobian, weighted, q, hypothesis_.lower(), hypothesis_.upper());
    return true;
  }

  /// The Newton decrement of Q at the point whose columns were asked for last. From afar, where these say little of what is to be
  /// gained, without end.
  double promised() const { return promised_; }

  /// d weighted / d q, by differences; nothing where a run breaks. What was found last is kept, for where a descent found
  /// nothing lower its beginning is asked again.
  std::optional<RowMajor> ColumnsAt(const Point& here, const VectorXd& weighted) const {
    if (columns_.size() > 0 && columns_at_ == here.q && columns_about_ == about_.q) return columns_;
    const VectorXd lower = hypothesis_.lower(), upper = hypothesis_.upper();
    RowMajor columns(weighted.size(), here.q.size());
    for (Index i = 0; i < here.q.size(); ++i) {
      VectorXd moved = here.q;
      const Parameter& parameter = hypothesis_.parameters()[static_cast<std::size_t>(i)];
      if (const std::optional<Index> column = KnownOf(parameter)) {
        columns.col(i) = Known(*column, i, weighted);
        continue;
      }
      double step = here.rough ? parameter.rough_step : central_ ? kCentralStep : parameter.step;
      const bool to_both_sides = central_ && here.q[i] + step <= upper[i] && here.q[i] - step >= lower[i];
      if (here.q[i] + step > upper[i]) step = -step;
      moved[i] = here.q[i] + step;
      const std::optional<Point> there = At(moved);
      if (!there) return std::nullopt;
      columns.col(i) = (Weighted(*there) - weighted) / step;
      if (!to_both_sides) continue;
      moved[i] = here.q[i] - step;
      const std::optional<Point> behind = At(moved);
      if (!behind) return std::nullopt;
      columns.col(i) = (Weighted(*there) - Weighted(*behind)) / (2.0 * step);
    }
    last_ = here;
    columns_ = columns;
    columns_at_ = here.q;
    columns_about_ = about_.q;
    return columns;
  }

  /// From now on Evaluate() gives the columns of this point, followed along the descent; empty: new ones at each point.
  void Keep(RowMajor columns, VectorXd q = {}, VectorXd weighted = {}) {
    kept_ = std::move(columns);
    kept_at_ = std::move(q);
    kept_weighted_ = std::move(weighted);
  }

  bool keeps_columns() const { return kept_.size() > 0; }

  /// The part of Q about this point that noise alone does not cause.
  double Excess() const {
    double excess = 0.0;
    for (std::size_t c = 0; c < scales_.size(); ++c) {
      const double noise = std::pow(scales_[c].noise_alone / scales_[c].rms, 2);
      excess += static_cast<double>(predictor_.data().channels()[c].count) / scales_[c].correlation *
                std::max(0.0, 1.0 - noise);
    }
    return excess;
  }

  const std::vector<ChannelScale>& scales() const { return scales_; }
  const std::string& broken() const { return broken_; }
  /// How many points were simulated.
  std::int64_t points() const { return points_; }
  Index rows() const { return rows_; }

 private:
  /// Broyden's update (1965): of all columns that give what the last step has changed, those nearest to the ones before.
  void Follow(const VectorXd& q, const VectorXd& weighted) const {
    const VectorXd step = q - kept_at_;
    if (!(step.squaredNorm() > 0.0)) return;
    const VectorXd missed = weighted - kept_weighted_ - kept_ * step;
    kept_ += missed * (step / step.squaredNorm()).transpose();
    kept_at_ = q;
    kept_weighted_ = weighted;
  }

  /// The column of another fit for the same number.
  std::optional<Index> KnownOf(const Parameter& parameter) const {
    if (!known_) return std::nullopt;
    const std::vector<Parameter>& others = known_->hypothesis->parameters();
    const auto same = std::ranges::find(others, parameter.name, &Parameter::name);
    return same != others.end() ? std::optional(same - others.begin()) : std::nullopt;
  }

  /// That column by the scales of this fit; `i`: of the number here.
  VectorXd Known(Index column, Index i, const VectorXd& weighted) const {
    const Estimate& other = *known_->estimate;
    VectorXd rows = VectorXd::Zero(num_residuals());
    for (std::size_t c = 0; c < scales_.size(); ++c) {
      const Channel& channel = predictor_.data().channels()[c];
      const double unit = other.scales[c].rms * std::sqrt(other.scales[c].correlation) /
                          (scales_[c].rms * std::sqrt(scales_[c].correlation));
      rows.segment(channel.begin, channel.count) =
          unit * other.jacobian.col(column).segment(channel.begin, channel.count);
      const auto k = static_cast<Index>(c);
      rows[rows_ + k] = unit * unit * other.noise_slope(k, column) / std::max(weighted[rows_ + k], 1e-300);
    }
    for (std::size_t k = 0; k < priors_.size(); ++k) {
      if (priors_[k] == i) rows[rows_ + std::ssize(scales_) + static_cast<Index>(k)] = 1.0;
    }
    return rows;
  }

  const Hypothesis& hypothesis_;
  const Predictor& predictor_;
  std::optional<KnownColumns> known_;
  bool central_, near_;
  Index rows_ = 0;
  std::vector<Index> priors_;
  mutable RowMajor kept_;
  mutable VectorXd kept_at_, kept_weighted_;
  mutable RowMajor columns_;  // found last
  mutable VectorXd columns_at_, columns_about_;
  mutable double promised_ = std::numeric_limits<double>::infinity();
  Point about_;
  std::vector<ChannelScale> scales_;
  mutable std::optional<Point> last_;
  mutable std::string broken_;
  mutable std::int64_t points_ = 0;
};

}  // namespace

double CorrelationTime(const Eigen::Ref<const VectorXd>& rows) {
  constexpr Index kMostLags = 400;
  const double power = rows.squaredNorm();
  if (!(power > 0.0)) return 1.0;
  const auto at = [&](Index lag) { return rows.head(rows.size() - lag).dot(rows.tail(rows.size() - lag)) / power; };
  double sum = 0.0;
  for (Index lag = 1; lag + 1 < std::min(kMostLags, rows.size() / 4); lag += 2) {
    const double pair = at(lag) + at(lag + 1);
    if (!(pair > 0.0)) break;
    sum += pair;
  }
  return 1.0 + 2.0 * sum;
}

std::vector<ChannelScale> ScalesOf(const DataSet& data, const VectorXd& innovations, const VectorXd& noise_alone) {
  std::vector<ChannelScale> scales;
  for (std::size_t c = 0; c < data.channels().size(); ++c) {
    const Channel& channel = data.channels()[c];
    const auto rows = innovations.segment(channel.begin, channel.count);
    const double rms = std::sqrt(rows.squaredNorm() / static_cast<double>(std::max<Index>(1, channel.count)));
    scales.push_back({std::max(rms, channel.noise), noise_alone[static_cast<Index>(c)], CorrelationTime(rows)});
  }
  return scales;
}

namespace {

/// Ends a descent where it has looked at as many points as it may, where its columns promise next to nothing, or where kept ones no
/// longer lead: Broyden's update changes them along the last step alone, so that in a curved valley each step gains a part of what it
/// promised, and the radius stays small. A step that gains little is no end: within a small radius it may leave nearly all that there is
/// to gain, where numbers make up for each other.
class DescentEnd : public ceres::IterationCallback {
 public:
  DescentEnd(const Residual& residual, double converged, std::int64_t most)
      : residual_(residual), converged_(converged), most_(most) {}
  ceres::CallbackReturnType operator()(const ceres::IterationSummary& step) override {
    const bool poor = step.iteration > 0 && residual_.keeps_columns() && step.relative_decrease < kPoor;
    poor_ = poor ? poor_ + 1 : 0;
    const bool exhausted = step.iteration > 0 && residual_.promised() < kNextToNothing * converged_;
    return residual_.points() >= most_ || poor_ == kPoorSteps || exhausted ? ceres::SOLVER_TERMINATE_SUCCESSFULLY
                                                                           : ceres::SOLVER_CONTINUE;
  }

 private:
  static constexpr double kPoor = 0.5;  // of what a step promised: Ceres leaves the radius as it is at half
  static constexpr int kPoorSteps = 3;  // one after the other
  const Residual& residual_;
  double converged_;  // what the fit asks for
  std::int64_t most_;
  int poor_ = 0;
};

/// Levenberg-Marquardt within the bounds. Says why it failed; empty: it did not.
std::string Descend(const Residual& residual, const EstimatorOptions& options, double converged, std::int64_t most,
                    const VectorXd& lower, const VectorXd& upper, const std::vector<Index>& held, double squares,
                    VectorXd& q, Estimate& estimate) {
  if (std::ssize(held) == q.size()) return "";
  ceres::Problem::Options ownership;
  ownership.cost_function_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
  ceres::Problem problem(ownership);
  problem.AddResidualBlock(const_cast<Residual*>(&residual), nullptr, q.data());
  for (Index i = 0; i < q.size(); ++i) {
    problem.SetParameterLowerBound(q.data(), static_cast<int>(i), lower[i]);
    problem.SetParameterUpperBound(q.data(), static_cast<int>(i), upper[i]);
  }
  // Ceres cuts a step off at the bounds: what is left of one across them goes uphill where numbers make up for each other.
  if (!held.empty())
    problem.SetManifold(q.data(), new ceres::SubsetManifold(static_cast<int>(q.size()), {held.begin(), held.end()}));
  ceres::Solver::Options solver;
  solver.linear_solver_type = ceres::DENSE_QR;
  solver.max_num_iterations = options.iterations;
  solver.function_tolerance = options.patient ? 0.0 : kNextToNothing * converged / squares;
  solver.parameter_tolerance = 1e-10;
  solver.gradient_tolerance = 1e-14;
  solver.logging_type = ceres::SILENT;
  // Where there are bounds, Ceres searches along each step. It does so by values alone: a slope would cost one simulation for
  // each parameter.
  solver.line_search_interpolation_type = ceres::BISECTION;
  solver.max_num_line_search_step_size_iterations = 3;
  if (options.near) {
    // Where columns are kept, a step that fails has a wrong direction: it is halved once, and a radius that shortens a step by 3 %
    // at first turns the next but one. From Ceres' own radius on the fifth would turn.
    solver.max_num_line_search_step_size_iterations = 1;
    solver.initial_trust_region_radius = 30.0;
  }
  solver.max_num_consecutive_invalid_steps = 10;
  DescentEnd end(residual, converged, most);
  solver.callbacks.push_back(&end);
  ceres::Solver::Summary summary;
  ceres::Solve(solver, &problem, &summary);
  estimate.iterations += static_cast<int>(summary.iterations.size());
  return summary.termination_type == ceres::FAILURE ? summary.message : "";
}

}  // namespace

Estimate Fit(const Hypothesis& hypothesis, const Predictor& predictor, const VectorXd& start,
             const EstimatorOptions& options) {
  Estimate estimate;
  Residual residual(hypothesis, predictor, options);
  const VectorXd lower = hypothesis.lower(), upper = hypothesis.upper();
  VectorXd q = start.cwiseMax(lower).cwiseMin(upper), weighted;
  RowMajor columns;
  std::optional<Point> point = residual.At(q);
  estimate.termination = "as often renewed as allowed";
  const std::int64_t most = options.points > 0 ? options.points : std::numeric_limits<std::int64_t>::max();
  bool fresh = !options.near;  // columns of their own for each step of the descent
  for (; point; ++estimate.renewals) {
    const std::vector<ChannelScale> old = residual.scales();
    residual.About(*point);
    weighted = residual.Weighted(*point);
    const double begun = residual.CriterionOf(weighted);
    if (!std::isfinite(begun)) estimate.broken = "the innovations are not finite";
    if (!estimate.ok() || q.size() == 0) break;
    bool settled = estimate.renewals > 0 && estimate.termination == kSettled;
    if (options.near || settled || estimate.renewals == options.renewals || residual.points() >= most) {
      const std::optional<RowMajor> here = residual.ColumnsAt(*point, weighted);
      if (!here) break;
      columns = *here;
    }
    const double converged = std::max(options.converged, options.of_excess * residual.Excess());
    if (options.near) {
      settled = DecrementOf(columns, weighted, q, lower, upper) < converged;
      for (std::size_t c = 0; c < old.size(); ++c)
        settled = settled && std::abs(residual.scales()[c].rms / old[c].rms - 1.0) < kSettledScale;
      if (settled) estimate.termination = kSettled;
    }
    if (settled || estimate.renewals == options.renewals || residual.points() >= most) break;
    // The columns of here serve for the whole descent, a simulation a step; where they lead nowhere, each step gets its own.
    if (!fresh) residual.Keep(columns, q, weighted);
    const std::vector<Index> held =
        columns.rows() > 0 ? HeldByBounds(columns.transpose() * weighted, q, lower, upper) : std::vector<Index>();
    estimate.broken =
        Descend(residual, options, converged, most, lower, upper, held, weighted.squaredNorm(), q, estimate);
    residual.Keep({});
    if (!estimate.ok()) break;
    const std::optional<Point> there = residual.At(q);
    const bool gained = there && begun - residual.CriterionOf(residual.Weighted(*there)) >= converged;
    if (options.near && !gained && there) {
      q = point->q;
      if (fresh) {
        estimate.termination = "no lower anywhere near";
        break;
      }
    } else {
      point = there;
    }
    if (options.near) {
      fresh = !gained;
    } else if (there && !gained) {
      const std::vector<ChannelScale> now = ScalesOf(predictor.data(), there->innovations, there->noise_alone);
      bool same = true;
      for (std::size_t c = 0; c < now.size(); ++c)
        same = same && std::abs(now[c].rms / residual.scales()[c].rms - 1.0) < kSettledScale;
      if (same) estimate.termination = kSettled;
    }
  }
  if (!point) estimate.broken = residual.broken();
  if (!estimate.ok()) return estimate;
  if (columns.rows() == 0 && q.size() > 0) {
    estimate.broken = residual.broken();
    return estimate;
  }
  estimate.q = point->q;
  estimate.innovations = point->innovations;
  estimate.scales = residual.scales();
  estimate.criterion = residual.CriterionOf(weighted);
  estimate.weighted = weighted.head(residual.rows());
  if (q.size() == 0) columns.resize(weighted.size(), 0);  // a model without numbers has rows all the same
  estimate.jacobian = columns.topRows(residual.rows());
  const Index channels = std::ssize(estimate.scales);
  estimate.noise_slope =
      weighted.segment(residual.rows(), channels).asDiagonal() * columns.middleRows(residual.rows(), channels);
  estimate.simulations = residual.points() * std::ssize(predictor.data().records());
  return estimate;
}

Eigen::MatrixXd HessianOf(const Eigen::MatrixXd& jacobian, const Hypothesis& hypothesis) {
  Eigen::MatrixXd hessian = jacobian.transpose() * jacobian;
  for (Index i = 0; i < hessian.rows(); ++i) {
    if (hypothesis.parameters()[static_cast<std::size_t>(i)].prior) hessian(i, i) += 1.0;
  }
  return hessian;
}

Eigen::MatrixXd Sandwich(const Estimate& estimate, const DataSet& data, const Hypothesis& hypothesis) {
  const Eigen::MatrixXd& J = estimate.jacobian;
  const Index p = J.cols();
  if (p == 0) return {};
  Eigen::MatrixXd meat = Eigen::MatrixXd::Zero(p, p);
  for (Index i = 0; i < p; ++i) {
    if (hypothesis.parameters()[static_cast<std::size_t>(i)].prior) meat(i, i) += 1.0;
  }
  for (const Block& block : BlocksOf(data)) {
    VectorXd score = VectorXd::Zero(p);
    for (const Block::Rows& rows : block.rows) {
      const Channel& channel = data.channels()[rows.channel];
      score += J.middleRows(rows.begin, rows.count).transpose() * estimate.weighted.segment(rows.begin, rows.count) +
               estimate.noise_slope.row(static_cast<Index>(rows.channel)).transpose() *
                   (static_cast<double>(rows.count) / static_cast<double>(channel.count));
    }
    meat += score * score.transpose();
  }
  const Eigen::MatrixXd inverse = dense::CovarianceOf(HessianOf(J, hypothesis));
  return inverse * meat * inverse;
}

Eigen::MatrixXd CurvatureOf(const Estimate& estimate, const Hypothesis& hypothesis) {
  if (estimate.jacobian.cols() == 0) return {};
  return dense::CovarianceOf(HessianOf(estimate.jacobian, hypothesis));
}

double LogLikelihood(const Estimate& estimate, const Predictor& predictor) {
  const DataSet& data = predictor.data();
  double sum = 0.0, rows = 0.0;
  for (const Channel& channel : data.channels()) {
    double variance = std::pow(channel.noise, 2);
    if (!predictor.free_run()) {
      const auto output = std::ranges::find(predictor.outputs(), channel.name) - predictor.outputs().begin();
      variance = predictor.observer()->innovation_covariance()(output, output);
    }
    const auto own = estimate.innovations.segment(channel.begin, channel.count);
    sum -= 0.5 * (static_cast<double>(channel.count) * std::log(variance) + own.squaredNorm() / variance);
    rows += static_cast<double>(channel.count);
  }
  return sum / std::max(rows, 1.0);
}

std::vector<Estimate> FitThrough(const Hypothesis& hypothesis, const std::vector<const Predictor*>& levels,
                                 const VectorXd& start, const EstimatorOptions& options) {
  std::vector<Estimate> estimates;
  VectorXd from = start;
  for (const Predictor* level : levels) {
    estimates.push_back(Fit(hypothesis, *level, from, options));
    if (estimates.back().ok()) from = estimates.back().q;
  }
  return estimates;
}

}  // namespace dynoproof::estimation
