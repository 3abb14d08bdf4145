// Estimator::Refine: effects and nuisance parameters all at once, by Levenberg-Marquardt over the free run.
#include <ceres/ceres.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "base/parallel.h"
#include "identification/coordinates.h"
#include "identification/estimator.h"
#include "identification/finite_difference.h"
#include "linear/dense.h"

namespace dynoproof::identification {
namespace {

/// Residuals: the whitened error, then the free nuisance parameters over their prior. Unknowns: the effects'
/// coordinates, then the free nuisance parameters over their prior.
class JointCost : public ceres::CostFunction {
 public:
  JointCost(const EstimationProblem& problem, const Whitener& whitener, const Coordinates& coordinates,
            std::optional<Eigen::Index> held, Eigen::MatrixXd known, Estimate& at)
      : problem_(problem),
        whitener_(whitener),
        coordinates_(coordinates),
        held_(held),
        known_(std::move(known)),
        at_(at) {
    set_num_residuals(static_cast<int>(problem.measured().size()) + Nuisances());
    mutable_parameter_block_sizes()->push_back(static_cast<int>(coordinates.size()) + Nuisances());
  }

  int Nuisances() const { return static_cast<int>(at_.nuisances.free.size()); }
  std::vector<double> Start() const {
    std::vector<double> x = coordinates_.Start();
    for (const int i : at_.nuisances.free) x.push_back(at_.hypothesis.z[Num(i)] / at_.nuisances.freedom[Num(i)]);
    return x;
  }
  Hypothesis At(const double* x) const {
    Hypothesis hypothesis = at_.hypothesis;
    if (coordinates_.size() > 0) hypothesis.effects = coordinates_.At(x);
    for (std::size_t k = 0; k < at_.nuisances.free.size(); ++k) {
      const std::size_t i = Num(at_.nuisances.free[k]);
      hypothesis.z[i] = x[coordinates_.size() + k] * at_.nuisances.freedom[i];
    }
    return hypothesis;
  }

  /// Where a Jacobian was asked for, `at` keeps the point, its prediction and the nuisance parameters' part of the
  /// Jacobian: the search asks for one at every point that it accepts.
  bool Evaluate(double const* const* parameters, double* residuals, double** jacobians) const override {
    const Eigen::Map<const Eigen::VectorXd> asked(parameters[0], parameter_block_sizes()[0]);
    const Eigen::Index rows = problem_.measured().size(), m = Nuisances(), p = asked.size() - m;
    const bool derive = jacobians != nullptr && jacobians[0] != nullptr;
    if (!Meet(asked)) return false;
    if (derive && !Derive()) return false;
    Eigen::Map<Eigen::VectorXd>(residuals, rows + m) = tried_.residual;
    if (!derive) return true;
    Eigen::MatrixXd jacobian = Eigen::MatrixXd::Zero(rows + m, p + m);
    at_.nuisances.jacobian.resize(rows, m);
    for (Eigen::Index k = 0; k < p + m; ++k) {
      jacobian.col(k).head(rows) = -whitener_(slopes_.col(k));
      if (k < p) continue;
      jacobian(rows + k - p, k) = 1.0;
      at_.nuisances.jacobian.col(k - p) = slopes_.col(k) / at_.nuisances.freedom[Num(at_.nuisances.free[Num(k - p)])];
    }
    Hold(jacobian);
    Eigen::Map<Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>>(jacobians[0], rows + m, p + m) =
        jacobian;
    base_ = tried_;
    jacobian_ = std::move(jacobian);
    at_.hypothesis = At(tried_.x.data());
    at_.nuisances.z0 = at_.hypothesis.z;
    at_.predicted = tried_.predicted;
    return jacobian_.allFinite();  // two runs that stand may lie too far apart
  }

  /// Whether the last slopes are differences.
  bool exact() const { return corrected_ == 0; }
  /// Whether they come from another point and have not been replaced by differences since.
  bool FollowsKnownSlopes() const { return known_in_use_; }

 private:
  struct Point {
    Eigen::VectorXd asked, x, predicted, residual;  // x: where the search asks for `asked`
  };

  std::optional<Point> Simulated(Eigen::VectorXd x) const {
    ++at_.simulations;
    Result<Eigen::VectorXd> predicted = problem_.Predict(At(x.data()));
    if (!predicted.ok() || !predicted->allFinite()) return std::nullopt;
    Point point{{}, std::move(x), *std::move(predicted), {}};
    point.residual.resize(problem_.measured().size() + Nuisances());
    point.residual << whitener_(problem_.measured() - point.predicted), point.x.tail(Nuisances());
    return point;
  }

  /// tried_ where the search wants to go: straight on from the last slopes' point, or along a parabola where straight
  /// on leads up the wall of a curved valley.
  bool Meet(const Eigen::VectorXd& asked) const {
    if (Is(tried_.asked, asked)) return true;
    const Eigen::VectorXd step = base_.x.size() > 0 ? Eigen::VectorXd(asked - base_.asked) : Eigen::VectorXd();
    std::optional<Point> met = Simulated(base_.x.size() > 0 ? Inside(base_.x + step) : asked);
    if (step.size() > 0 && step.squaredNorm() > 0.0) {
      const double here = base_.residual.squaredNorm();
      const double foretold = here - (base_.residual + jacobian_ * step).squaredNorm();
      if (!met || here - met->residual.squaredNorm() < 0.25 * foretold) {
        std::optional<Point> bent = Bent(step);
        if (bent && (!met || bent->residual.squaredNorm() < met->residual.squaredNorm())) met = std::move(bent);
      }
    }
    if (!met) return false;
    met->asked = asked;
    tried_ = *std::move(met);
    return true;
  }

  /// A sharp mode's frequency must not change by more than its width, whatever else does: such hypotheses lie in narrow
  /// curved valleys, in which straight steps get nowhere. The second derivative along the step, from one simulation at
  /// a tenth of it, tells how the valley bends (geodesic acceleration, Transtrum and Sethna 2012).
  std::optional<Point> Bent(const Eigen::VectorXd& step) const {
    constexpr double kShare = 0.1, kMostBent = 0.75;
    const std::optional<Point> near = Simulated(Inside(base_.x + kShare * step));
    if (!near) return std::nullopt;
    Eigen::MatrixXd curvature = jacobian_.transpose() * jacobian_;
    const Eigen::VectorXd slope = jacobian_.transpose() * base_.residual;
    // The damping that the search has just used follows from the step itself: (J'J + lambda I) step = -J'r.
    curvature.diagonal().array() += std::max(0.0, -(slope + curvature * step).dot(step) / step.squaredNorm());
    const Eigen::VectorXd missed = (near->residual - base_.residual - kShare * jacobian_ * step) / (kShare * kShare);
    const Eigen::VectorXd bend = -dense::SolveLdlt(curvature, jacobian_.transpose() * missed);
    if (!(bend.norm() < kMostBent * step.norm())) return std::nullopt;
    return Simulated(Inside(base_.x + step + bend));
  }

  /// What is at a bound and wants further out, stays: the other unknowns then find their best without it.
  void Hold(Eigen::MatrixXd& jacobian) const {
    for (std::size_t i = 0; i < coordinates_.size(); ++i) {
      const auto k = static_cast<Eigen::Index>(i);
      const double rise = jacobian.col(k).dot(tried_.residual);
      if ((tried_.x[k] <= coordinates_.lower(i) && rise > 0.0) || (tried_.x[k] >= coordinates_.upper(i) && rise < 0.0))
        jacobian.col(k).setZero();
    }
  }

  /// The effects' coordinates within their bounds.
  Eigen::VectorXd Inside(Eigen::VectorXd x) const {
    for (std::size_t i = 0; i < coordinates_.size(); ++i) {
      const auto k = static_cast<Eigen::Index>(i);
      x[k] = std::clamp(x[k], coordinates_.lower(i), coordinates_.upper(i));
    }
    return x;
  }

  static bool Is(const Eigen::VectorXd& a, const Eigen::VectorXd& b) {
    return a.size() == b.size() && (a.array() == b.array()).all();
  }

  /// slopes_ at tried_: at the start those that are known, if any. As long as the slopes foretell most of each step they are corrected by what they missed
  /// (Broyden 1965), which costs nothing; else, and every few steps, taken anew by differences.
  bool Derive() const {
    constexpr double kForetold = 0.2;
    constexpr int kMostInARow = 3;
    if (base_.x.size() > 0 && corrected_ < kMostInARow && !Is(tried_.x, base_.x)) {
      const Eigen::VectorXd step = tried_.x - base_.x;
      const Eigen::VectorXd change = tried_.predicted - base_.predicted;
      const Eigen::VectorXd missed = change - slopes_ * step;
      if (whitener_(missed).norm() < kForetold * whitener_(change).norm()) {
        slopes_ += missed * (step / step.squaredNorm()).transpose();
        ++corrected_;
        return true;
      }
    }
    const Eigen::Index p = static_cast<Eigen::Index>(coordinates_.size());
    if (base_.x.size() == 0 && known_.cols() == Nuisances() && known_.rows() == problem_.measured().size()) {
      if (!Differences(tried_.x, p)) return false;
      for (Eigen::Index k = 0; k < Nuisances(); ++k)
        slopes_.col(p + k) = known_.col(k) * at_.nuisances.freedom[Num(at_.nuisances.free[Num(k)])];
      corrected_ = 1;
      known_in_use_ = true;
      return true;
    }
    corrected_ = 0;
    known_in_use_ = false;
    return Differences(tried_.x, tried_.x.size());
  }

  /// Of the first `count` unknowns.
  bool Differences(const Eigen::VectorXd& x, Eigen::Index count) const {
    const Eigen::Index p = static_cast<Eigen::Index>(coordinates_.size());
    const bool wide = NeedsWideDifferences(at_.hypothesis.effects);
    slopes_.resize(problem_.measured().size(), x.size());
    std::atomic<bool> good = true;
    std::atomic<int> simulations = 0;
    ParallelFor(Num(count), 0, [&](std::size_t k) {
      const auto column = static_cast<Eigen::Index>(k);
      if (column == held_) {
        slopes_.col(column).setZero();
        return;
      }
      const double step = column < p ? coordinates_.Difference(k, x[column])
                                     : kNuisanceStep / at_.nuisances.freedom[Num(at_.nuisances.free[Num(column - p)])];
      const auto predicted = [&](double by) {
        Eigen::VectorXd moved = x;
        moved[column] += by;
        return problem_.Predict(At(moved.data()));
      };
      const std::optional<Difference> difference = DifferenceOf(predicted, tried_.predicted, whitener_, step, wide);
      if (difference) {
        slopes_.col(column) = difference->change / difference->step;
        simulations += difference->simulations;
      } else {
        good = false;
      }
    });
    at_.simulations += simulations;
    return good;
  }

  static std::size_t Num(Eigen::Index i) { return static_cast<std::size_t>(i); }

  const EstimationProblem& problem_;
  const Whitener& whitener_;
  const Coordinates& coordinates_;
  const std::optional<Eigen::Index> held_;
  const Eigen::MatrixXd known_;  // d predicted / d z of the free nuisance parameters, near the start
  Estimate& at_;
  // What is known of the points the search has been at: it asks for residuals first, then there for slopes.
  mutable Point tried_, base_;      // base_: where the slopes are
  mutable Eigen::MatrixXd slopes_;  // of the prediction, by column of x
  mutable Eigen::MatrixXd jacobian_;
  mutable bool known_in_use_ = false;
  mutable int corrected_ = 0;  // times since the last differences of all unknowns
};

/// Ends the search after so many accepted steps, where slopes that were known lead nowhere, and where its allowance is
/// spent.
class AfterRounds : public ceres::IterationCallback {
 public:
  AfterRounds(int rounds, const JointCost& cost, const EstimationProblem& problem)
      : left_(rounds), cost_(cost), problem_(problem) {}
  ceres::CallbackReturnType operator()(const ceres::IterationSummary& summary) override {
    if (summary.iteration > 0 && summary.step_is_successful) --left_;
    misled_ = summary.iteration > 0 && !summary.step_is_successful && cost_.FollowsKnownSlopes();
    if (problem_.spent()) {
      misled_ = false;
      return ceres::SOLVER_TERMINATE_SUCCESSFULLY;
    }
    return left_ > 0 && !misled_ ? ceres::SOLVER_CONTINUE : ceres::SOLVER_TERMINATE_SUCCESSFULLY;
  }
  bool misled() const { return misled_; }

 private:
  int left_;
  bool misled_ = false;
  const JointCost& cost_;
  const EstimationProblem& problem_;
};

}  // namespace

Estimate Estimator::Refine(Estimate fit, int rounds, const RefineOptions& wanted) const {
  fit.settled = false;
  if (!fit.ok()) return fit;
  fit.nuisances.freedom = FreedomOf(problem_, fit.hypothesis.effects);
  fit.nuisances.free = FreeOf(fit.nuisances.freedom);
  Eigen::MatrixXd known = std::exchange(fit.nuisances.jacobian, {});
  if (wanted.slopes == Slopes::kDifferences) known.resize(0, 0);
  const Coordinates coordinates(wanted.moves == Moves::kAll ? fit.hypothesis.effects : std::vector<EffectInstance>{});
  JointCost cost(problem_, whitener_, coordinates, wanted.held, std::move(known), fit);
  std::vector<double> x = cost.Start();
  ceres::Problem::Options kept;
  kept.cost_function_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
  ceres::Problem problem(kept);
  if (x.empty()) {
    fit.settled = true;
    Score(fit);
    return fit;
  }
  problem.AddResidualBlock(&cost, nullptr, x.data());
  AfterRounds callback(rounds, cost, problem_);
  ceres::Solver::Options options;
  options.linear_solver_type = ceres::DENSE_QR;
  // Steps are damped in the unknowns' own units, spreads of the nuisance parameters and shares of the effects: by the
  // data's units, a sharp mode would damp every step along its valley.
  options.jacobi_scaling = false;
  options.min_lm_diagonal = options.max_lm_diagonal = options.initial_trust_region_radius = 1.0;
  options.max_num_iterations = 6 * rounds;
  options.function_tolerance = 0.1 / whitener_.rows();  // of chi2: a tenth, far below what decides
  options.parameter_tolerance = 1e-9;
  options.callbacks.push_back(&callback);
  options.logging_type = ceres::SILENT;
  ceres::Solver::Summary summary;
  do {
    ceres::Solve(options, &problem, &summary);
  } while (callback.misled());               // goes on from where it is, with differences
  if (fit.nuisances.jacobian.rows() == 0) {  // not even the start, or a run beside it, stood
    fit.broken = summary.message;
    return fit;
  }
  fit.settled = summary.termination_type == ceres::CONVERGENCE && cost.exact();
  Score(fit);
  return fit;
}

}  // namespace dynoproof::identification
