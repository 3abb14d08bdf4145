// Fitter::Polish: effects and doubts all at once, by Levenberg-Marquardt over the free run.
#include <ceres/ceres.h>

#include <algorithm>
#include <cmath>

#include "diagnosis/coordinates.h"
#include "diagnosis/fit.h"
#include "diagnosis/parallel.h"

namespace dynoproof::diagnosis {
namespace {

/// Residuals: the whitened error, then the free doubts over their prior. Unknowns: the effects' coordinates, then the
/// free doubts over their prior.
class JointCost : public ceres::CostFunction {
 public:
  JointCost(const Study& study, const Whitener& whitener, const Coordinates& coordinates, Fit& at)
      : study_(study), whitener_(whitener), coordinates_(coordinates), at_(at) {
    set_num_residuals(static_cast<int>(study.measured().size()) + Doubts());
    mutable_parameter_block_sizes()->push_back(static_cast<int>(coordinates.size()) + Doubts());
  }

  int Doubts() const { return static_cast<int>(at_.doubts.free.size()); }
  std::vector<double> Start() const {
    std::vector<double> x = coordinates_.Start();
    for (const int i : at_.doubts.free) x.push_back(at_.hypothesis.z[Num(i)] / at_.doubts.freedom[Num(i)]);
    return x;
  }
  Hypothesis At(const double* x) const {
    Hypothesis hypothesis = at_.hypothesis;
    if (coordinates_.size() > 0) hypothesis.effects = coordinates_.At(x);
    for (std::size_t k = 0; k < at_.doubts.free.size(); ++k) {
      const std::size_t i = Num(at_.doubts.free[k]);
      hypothesis.z[i] = x[coordinates_.size() + k] * at_.doubts.freedom[i];
    }
    return hypothesis;
  }

  /// Where a Jacobian was asked for, `at` keeps the point, its prediction and the doubts' part of the Jacobian: the
  /// search asks for one at every point that it accepts.
  bool Evaluate(double const* const* parameters, double* residuals, double** jacobians) const override {
    const Eigen::Map<const Eigen::VectorXd> x(parameters[0], parameter_block_sizes()[0]);
    const Eigen::Index rows = study_.measured().size(), m = Doubts(), p = x.size() - m;
    const bool derive = jacobians != nullptr && jacobians[0] != nullptr;
    if (!(derive ? Derive(x) : Simulate(x))) return false;
    Eigen::Map<Eigen::VectorXd> out(residuals, rows + m);
    out.head(rows) = whitener_(study_.measured() - tried_.predicted);
    out.tail(m) = x.tail(m);
    if (!derive) return true;
    Eigen::Map<Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>> jacobian(jacobians[0],
                                                                                                out.size(), p + m);
    jacobian.setZero();
    at_.doubts.jacobian.resize(rows, m);
    for (Eigen::Index k = 0; k < p + m; ++k) {
      jacobian.col(k).head(rows) = -whitener_(slopes_.col(k));
      if (k < p) continue;
      jacobian(rows + k - p, k) = 1.0;
      at_.doubts.jacobian.col(k - p) = slopes_.col(k) / at_.doubts.freedom[Num(at_.doubts.free[Num(k - p)])];
    }
    at_.hypothesis = At(x.data());
    at_.doubts.z0 = at_.hypothesis.z;
    at_.predicted = tried_.predicted;
    return jacobian.allFinite();  // two runs that stand may lie too far apart
  }

  /// Whether the last slopes are differences.
  bool exact() const { return corrected_ == 0; }

 private:
  struct Point {
    Eigen::VectorXd x, predicted;
  };

  /// tried_ at x.
  bool Simulate(const Eigen::VectorXd& x) const {
    if (tried_.x.size() == x.size() && (tried_.x.array() == x.array()).all()) return true;
    ++at_.simulations;
    Result<Eigen::VectorXd> predicted = study_.Predict(At(x.data()));
    if (!predicted.ok() || !predicted->allFinite()) return false;
    tried_ = {x, *std::move(predicted)};
    return true;
  }

  /// tried_ and slopes_ at x. As long as the slopes foretell most of each step they are corrected by what they missed
  /// (Broyden 1965), which costs nothing; else, and every few steps, taken anew by differences.
  bool Derive(const Eigen::VectorXd& x) const {
    constexpr double kForetold = 0.2;
    constexpr int kMostInARow = 3;
    if (!Simulate(x)) return false;
    if (derived_.x.size() == x.size() && corrected_ < kMostInARow) {
      const Eigen::VectorXd step = x - derived_.x;
      const Eigen::VectorXd change = tried_.predicted - derived_.predicted;
      const Eigen::VectorXd missed = change - slopes_ * step;
      if (whitener_(missed).norm() < kForetold * whitener_(change).norm()) {
        slopes_ += missed * (step / step.squaredNorm()).transpose();
        ++corrected_;
        derived_ = tried_;
        return true;
      }
    }
    corrected_ = 0;
    derived_ = tried_;
    return Differences(x);
  }

  bool Differences(const Eigen::VectorXd& x) const {
    const Eigen::Index p = static_cast<Eigen::Index>(coordinates_.size());
    slopes_.resize(study_.measured().size(), x.size());
    std::atomic<bool> good = true;
    ParallelFor(Num(x.size()), 0, [&](std::size_t k) {
      const auto column = static_cast<Eigen::Index>(k);
      Eigen::VectorXd moved = x;
      const double step = column < p ? coordinates_.Difference(k, x[column])
                                     : kDoubtStep / at_.doubts.freedom[Num(at_.doubts.free[Num(column - p)])];
      moved[column] += step;
      const Result<Eigen::VectorXd> predicted = study_.Predict(At(moved.data()));
      if (predicted.ok() && predicted->allFinite())
        slopes_.col(column) = (*predicted - tried_.predicted) / step;
      else
        good = false;
    });
    at_.simulations += static_cast<int>(x.size());
    return good;
  }

  static std::size_t Num(Eigen::Index i) { return static_cast<std::size_t>(i); }

  const Study& study_;
  const Whitener& whitener_;
  const Coordinates& coordinates_;
  Fit& at_;
  // What is known of the points the search has been at: it asks for residuals first, then there for slopes.
  mutable Point tried_, derived_;
  mutable Eigen::MatrixXd slopes_;  // of the prediction at derived_, by column of x
  mutable int corrected_ = 0;       // times since the last differences
};

/// Ends the search after so many accepted steps; what is tried and rejected costs one simulation.
class AfterRounds : public ceres::IterationCallback {
 public:
  explicit AfterRounds(int rounds) : left_(rounds) {}
  ceres::CallbackReturnType operator()(const ceres::IterationSummary& summary) override {
    if (summary.iteration > 0 && summary.step_is_successful) --left_;
    return left_ > 0 ? ceres::SOLVER_CONTINUE : ceres::SOLVER_TERMINATE_SUCCESSFULLY;
  }

 private:
  int left_;
};

}  // namespace

Fit Fitter::Polish(Fit fit, int rounds, Moves moves) const {
  fit.settled = false;
  if (!fit.ok()) return fit;
  fit.doubts.freedom = FreedomOf(study_, fit.hypothesis.effects);
  fit.doubts.free = FreeOf(fit.doubts.freedom);
  fit.doubts.jacobian.resize(0, 0);  // another point's, if any
  const Coordinates coordinates(moves == Moves::kAll ? fit.hypothesis.effects : std::vector<Assumed>{});
  JointCost cost(study_, whitener_, coordinates, fit);
  std::vector<double> x = cost.Start();
  ceres::Problem::Options kept;
  kept.cost_function_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
  ceres::Problem problem(kept);
  if (x.empty()) {
    fit.settled = true;
    Weigh(fit);
    return fit;
  }
  problem.AddResidualBlock(&cost, nullptr, x.data());
  for (std::size_t i = 0; i < coordinates.size(); ++i) {
    problem.SetParameterLowerBound(x.data(), static_cast<int>(i), coordinates.lower(i));
    problem.SetParameterUpperBound(x.data(), static_cast<int>(i), coordinates.upper(i));
  }
  AfterRounds callback(rounds);
  ceres::Solver::Options options;
  options.linear_solver_type = ceres::DENSE_QR;
  options.max_num_iterations = 6 * rounds;
  options.function_tolerance = 0.5 / whitener_.rows();  // of chi2: a half, far below what decides
  options.parameter_tolerance = 1e-9;
  options.callbacks.push_back(&callback);
  options.logging_type = ceres::SILENT;
  ceres::Solver::Summary summary;
  ceres::Solve(options, &problem, &summary);
  if (fit.doubts.jacobian.rows() == 0) {  // not even the start, or a run beside it, stood
    fit.broken = summary.message;
    return fit;
  }
  fit.settled = summary.termination_type == ceres::CONVERGENCE && cost.exact();
  Weigh(fit);
  return fit;
}

}  // namespace dynoproof::diagnosis
