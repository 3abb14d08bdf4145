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
    const double* x = parameters[0];
    const bool derive = jacobians != nullptr && jacobians[0] != nullptr;
    const std::size_t p = coordinates_.size(), m = at_.doubts.free.size();
    const Eigen::Index rows = study_.measured().size();
    std::vector<Eigen::VectorXd> points(derive ? p + m + 1 : 1);
    std::vector<double> steps(p + m, 0.0);
    std::atomic<bool> good = true;
    ParallelFor(points.size(), 0, [&](std::size_t k) {
      std::vector<double> moved(x, x + p + m);
      if (k > 0) {
        steps[k - 1] = k <= p ? coordinates_.Difference(k - 1, moved[k - 1])
                              : kDoubtStep / at_.doubts.freedom[Num(at_.doubts.free[k - 1 - p])];
        moved[k - 1] += steps[k - 1];
      }
      Result<Eigen::VectorXd> predicted = study_.Predict(At(moved.data()));
      if (predicted.ok() && predicted->allFinite())
        points[k] = std::move(*predicted);
      else
        good = false;
    });
    at_.simulations += static_cast<int>(points.size());
    if (!good) return false;
    Eigen::Map<Eigen::VectorXd> out(residuals, rows + static_cast<Eigen::Index>(m));
    out.head(rows) = whitener_(study_.measured() - points[0]);
    out.tail(static_cast<Eigen::Index>(m)) = Eigen::Map<const Eigen::VectorXd>(x + p, static_cast<Eigen::Index>(m));
    if (!derive) return true;
    Eigen::Map<Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>> jacobian(
        jacobians[0], out.size(), static_cast<Eigen::Index>(p + m));
    jacobian.setZero();
    DoubtModel& doubts = at_.doubts;
    doubts.jacobian.resize(rows, static_cast<Eigen::Index>(m));
    for (std::size_t k = 0; k < p + m; ++k) {
      const auto column = static_cast<Eigen::Index>(k);
      points[k + 1] = (points[k + 1] - points[0]) / steps[k];
      jacobian.col(column).head(rows) = -whitener_(points[k + 1]);
      if (k < p) continue;
      jacobian(rows + column - static_cast<Eigen::Index>(p), column) = 1.0;
      doubts.jacobian.col(column - static_cast<Eigen::Index>(p)) =
          points[k + 1] / doubts.freedom[Num(doubts.free[k - p])];
    }
    at_.hypothesis = At(x);
    doubts.z0 = at_.hypothesis.z;
    at_.predicted = std::move(points[0]);
    return jacobian.allFinite();  // two runs that stand may lie too far apart
  }

 private:
  static std::size_t Num(int i) { return static_cast<std::size_t>(i); }

  const Study& study_;
  const Whitener& whitener_;
  const Coordinates& coordinates_;
  Fit& at_;
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
  fit.settled = summary.termination_type == ceres::CONVERGENCE;
  Weigh(fit);
  return fit;
}

}  // namespace dynoproof::diagnosis
