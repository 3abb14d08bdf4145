#include "identification/multi_start.h"

#include <ceres/ceres.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>

#include "base/parallel.h"
#include "base/random.h"

namespace dynoproof::identification {
namespace {

// Small beside the width of a sharp resonance, far above the round-off of a free run.
constexpr double kStep = 1e-5;
constexpr double kNear = 0.1;     // of the nominal value: where starts lie without bounds
constexpr double kLinear = 1e-3;  // of the larger bound: up to there an axis through zero is linear

/// A objective as Ceres wants it.
class Cost : public ceres::CostFunction {
 public:
  Cost(const Plan& plan, const Objective& objective, const std::vector<Axis>& axes)
      : plan_(plan), misfit_(objective), axes_(axes) {
    set_num_residuals(static_cast<int>(objective.size()));
    mutable_parameter_block_sizes()->push_back(static_cast<int>(axes.size()));
  }

  Result<Eigen::VectorXd> Error(const std::vector<double>& x) const { return misfit_.Of(With(plan_, axes_, x)); }

  /// The error's derivative; empty where a run breaks.
  Eigen::MatrixXd Jacobian(const std::vector<double>& x, const Eigen::VectorXd& at) const {
    Eigen::MatrixXd jacobian(at.size(), static_cast<Eigen::Index>(x.size()));
    std::atomic<bool> good = true;
    ParallelFor(x.size(), 0, [&](std::size_t k) {
      std::vector<double> moved = x;
      const double step = x[k] + kStep > axes_[k].high ? -kStep : kStep;
      moved[k] += step;
      const Result<Eigen::VectorXd> error = Error(moved);
      if (!error.ok() || !error->allFinite()) {
        good = false;
        return;
      }
      jacobian.col(static_cast<Eigen::Index>(k)) = (*error - at) / step;
    });
    return good ? jacobian : Eigen::MatrixXd();
  }

  bool Evaluate(double const* const* parameters, double* residuals, double** jacobians) const override {
    const std::vector<double> x(parameters[0], parameters[0] + axes_.size());
    const Result<Eigen::VectorXd> error = Error(x);
    if (!error.ok() || !error->allFinite()) return false;
    Eigen::Map<Eigen::VectorXd>(residuals, error->size()) = *error;
    if (jacobians == nullptr || jacobians[0] == nullptr) return true;
    const Eigen::MatrixXd jacobian = Jacobian(x, *error);
    if (jacobian.size() == 0) return false;
    Eigen::Map<Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>>(jacobians[0], jacobian.rows(),
                                                                                       jacobian.cols()) = jacobian;
    return true;
  }

 private:
  const Plan& plan_;
  const Objective& misfit_;
  const std::vector<Axis>& axes_;
};

/// Where the search for the `start`-th time begins.
std::vector<double> StartOf(const Cost& cost, const std::vector<Axis>& axes, std::size_t count, int start) {
  std::vector<std::vector<double>> tries(count);
  std::vector<double> squares(tries.size(), std::numeric_limits<double>::infinity());
  ParallelFor(tries.size(), 0, [&](std::size_t i) {
    for (std::size_t k = 0; k < axes.size(); ++k)
      tries[i].push_back(axes[k].Start(RandomUniform(static_cast<std::uint64_t>(start), 1, count * k + i)));
    const Result<Eigen::VectorXd> error = cost.Error(tries[i]);
    if (error.ok() && error->allFinite()) squares[i] = error->squaredNorm();
  });
  return tries[static_cast<std::size_t>(std::min_element(squares.begin(), squares.end()) - squares.begin())];
}

}  // namespace

Axis::Axis(const FreeKey& free, double value) : key(free.key), nominal(value) {
  if (!free.bounds) {
    unit_ = nominal;
    low = -std::log(kWithoutBounds), high = std::log(kWithoutBounds);
    return;
  }
  const auto [lower, upper] = *free.bounds;
  logarithmic_ = (lower > 0.0 && upper > 0.0) || (lower < 0.0 && upper < 0.0);
  // The logarithm of value / nominal where the nominal lies within, else of value / bound.
  unit_ = logarithmic_ ? ((nominal > 0.0 && lower > 0.0) || (nominal < 0.0 && lower < 0.0) ? nominal : lower)
                       : kLinear * std::max(std::abs(lower), std::abs(upper));
  low = std::min(At(lower), At(upper));
  high = std::max(At(lower), At(upper));
  anywhere_ = true;
}

double Axis::At(double value) const { return logarithmic_ ? std::log(value / unit_) : std::asinh(value / unit_); }
double Axis::ValueAt(double x) const { return unit_ * (logarithmic_ ? std::exp(x) : std::sinh(x)); }
double Axis::Slope(double x) const { return unit_ * (logarithmic_ ? std::exp(x) : std::cosh(x)); }
double Axis::Start(double share) const { return anywhere_ ? low + share * (high - low) : kNear * (2.0 * share - 1.0); }
double Axis::Nominal() const {
  return !logarithmic_ || nominal / unit_ > 0.0 ? std::clamp(At(nominal), low, high) : low;
}
bool Axis::OnBound(double x) const { return std::min(x - low, high - x) < 1e-3 * (high - low); }

Plan With(Plan plan, const std::vector<Axis>& axes, const std::vector<double>& x) {
  for (std::size_t i = 0; i < axes.size(); ++i) *plan.root.FindPath(axes[i].key) = axes[i].ValueAt(x[i]);
  return plan;
}

std::size_t TriesOf(const std::vector<FreeKey>& keys, bool by_runs) {
  const bool anywhere =
      std::any_of(keys.begin(), keys.end(), [](const FreeKey& free) { return free.bounds.has_value(); });
  return !anywhere ? 1 : by_runs ? 20 : 200;
}

Result<Optimum> Minimise(const Plan& plan, const Objective& objective, const std::vector<Axis>& axes,
                         const MultiStartOptions& options) {
  const Cost cost(plan, objective, axes);
  Optimum best;
  for (const Axis& axis : axes) best.x.push_back(axis.Nominal());
  const Result<Eigen::VectorXd> before = cost.Error(best.x);
  if (!before.ok()) return before.failure();
  if (before->size() == 0 || !before->allFinite())
    return Failure{
        .message = "nothing to compare: an output is constant, or all noise", .signal = plan.id, .exit_code = 4};
  const std::vector<double> nominal = best.x;
  double lowest = before->squaredNorm() * (1.0 + 1e-12);
  std::vector<double> costs;
  for (int start = 0; start < options.starts; ++start) {
    options.progress(static_cast<double>(start) / options.starts);
    std::vector<double> x = start > 0               ? StartOf(cost, axes, options.tries, start)
                            : options.first.empty() ? nominal
                                                    : options.first;
    ceres::Problem problem;
    problem.AddResidualBlock(new Cost(plan, objective, axes), nullptr, x.data());
    for (std::size_t k = 0; k < x.size(); ++k) {
      problem.SetParameterLowerBound(x.data(), static_cast<int>(k), axes[k].low);
      problem.SetParameterUpperBound(x.data(), static_cast<int>(k), axes[k].high);
    }
    ceres::Solver::Options solving;
    solving.linear_solver_type = ceres::DENSE_QR;
    solving.max_num_iterations = 100;
    solving.function_tolerance = 1e-8;
    solving.logging_type = ceres::SILENT;
    ceres::Solver::Summary summary;
    ceres::Solve(solving, &problem, &summary);
    if (!summary.IsSolutionUsable()) continue;
    costs.push_back(2.0 * summary.final_cost);
    if (costs.back() < lowest) lowest = costs.back(), best.x = x;
  }
  for (const double one : costs) best.converged += one <= lowest * 1.001 ? 1 : 0;
  Result<Eigen::VectorXd> error = cost.Error(best.x);
  if (!error.ok()) return error.failure();
  best.jacobian = cost.Jacobian(best.x, *error);
  if (best.jacobian.size() == 0) return Failure{"the run breaks beside the optimum", plan.id};
  best.error = *std::move(error);
  return best;
}

}  // namespace dynoproof::identification
