#include "identification/estimator.h"

#include <ceres/ceres.h>

#include <algorithm>
#include <cmath>
#include <mutex>

#include "base/parallel.h"
#include "identification/coordinates.h"
#include "identification/finite_difference.h"
#include "linear/dense.h"

namespace dynoproof::identification {
namespace {

// A change of structure re-draws the line: the values of the parts around it were fitted to the wrong structure and are
// worth little. 40 spreads: 40 % of an inertia or stiffness.
constexpr double kWide = 40.0;

class FreeRunCost : public ceres::CostFunction {
 public:
  FreeRunCost(const EstimationProblem& problem, const Whitener& whitener, const NuisanceModel& nuisances,
              const Projection& projection, const Coordinates& coordinates, int* simulations)
      : problem_(problem),
        whitener_(whitener),
        nuisances_(nuisances),
        projection_(projection),
        coordinates_(coordinates),
        simulations_(simulations) {
    set_num_residuals(static_cast<int>(problem.measured().size() + static_cast<Eigen::Index>(nuisances.free.size())));
    mutable_parameter_block_sizes()->push_back(static_cast<int>(coordinates.size()));
  }

  bool Evaluate(double const* const* parameters, double* residuals, double** jacobians) const override {
    const double* x = parameters[0];
    const std::size_t n = coordinates_.size();
    const bool derive = jacobians != nullptr && jacobians[0] != nullptr;
    std::vector<Eigen::VectorXd> points(derive ? n + 1 : 1);
    std::vector<double> steps(n, 0.0);
    std::atomic<bool> good = true;
    ParallelFor(points.size(), 0, [&](std::size_t k) {
      std::vector<double> at(x, x + n);
      if (k > 0) {
        steps[k - 1] = coordinates_.Difference(k - 1, at[k - 1]);
        at[k - 1] += steps[k - 1];
      }
      const Result<Eigen::VectorXd> predicted = problem_.Predict({nuisances_.z0, coordinates_.At(at.data())});
      if (!predicted.ok() || !predicted->allFinite()) {
        good = false;
        return;
      }
      const Eigen::VectorXd error = whitener_(problem_.measured() - *predicted);
      points[k] = projection_.Residual(error, projection_.Shift(error));
    });
    *simulations_ += static_cast<int>(points.size());
    if (!good) return false;
    Eigen::Map<Eigen::VectorXd>(residuals, points[0].size()) = points[0];
    if (!derive) return true;
    Eigen::Map<Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>> out(
        jacobians[0], points[0].size(), static_cast<Eigen::Index>(n));
    for (std::size_t k = 0; k < n; ++k) out.col(static_cast<Eigen::Index>(k)) = (points[k + 1] - points[0]) / steps[k];
    return out.allFinite();  // two runs that stand may lie too far apart
  }

 private:
  const EstimationProblem& problem_;
  const Whitener& whitener_;
  const NuisanceModel& nuisances_;
  const Projection& projection_;
  const Coordinates& coordinates_;
  int* simulations_;
};

}  // namespace

Projection::Projection(const NuisanceModel& nuisances, const Whitener& whitener) {
  const auto m = static_cast<Eigen::Index>(nuisances.free.size());
  white_.resize(nuisances.jacobian.rows(), m);
  prior_.resize(m);
  centre_.resize(m);
  for (Eigen::Index k = 0; k < m; ++k) {
    white_.col(k) = whitener(nuisances.jacobian.col(k));
    const auto i = static_cast<std::size_t>(nuisances.free[static_cast<std::size_t>(k)]);
    prior_[k] = 1.0 / nuisances.freedom[i];
    centre_[k] = nuisances.z0[i];
  }
  if (m == 0) return;
  Eigen::MatrixXd information = white_.transpose() * white_;
  information.diagonal() += prior_.cwiseAbs2();
  factor_.compute(information);
  log_det_ = factor_.vectorD().array().max(1e-300).log().sum() - 2.0 * prior_.array().log().sum();
}

Eigen::VectorXd Projection::Shift(const Eigen::VectorXd& error) const {
  if (prior_.size() == 0) return {};
  return factor_.solve(white_.transpose() * error - prior_.cwiseAbs2().cwiseProduct(centre_));
}

Eigen::VectorXd Projection::Residual(const Eigen::VectorXd& error, const Eigen::VectorXd& shift) const {
  Eigen::VectorXd all(error.size() + prior_.size());
  all.head(error.size()) = error;
  if (prior_.size() > 0) {
    all.head(error.size()).noalias() -= white_ * shift;
    all.tail(prior_.size()) = prior_.cwiseProduct(centre_ + shift);
  }
  return all;
}

Eigen::VectorXd Projection::Free(const Eigen::VectorXd& white) const {
  Eigen::VectorXd all(white.size() + prior_.size());
  all.head(white.size()) = white;
  if (prior_.size() > 0) {
    const Eigen::VectorXd shift = factor_.solve(white_.transpose() * white);
    all.head(white.size()).noalias() -= white_ * shift;
    all.tail(prior_.size()) = prior_.cwiseProduct(shift);
  }
  return all;
}

std::string Estimate::Name() const {
  std::string name;
  for (const EffectInstance& instance : hypothesis.effects) name += (name.empty() ? "" : " + ") + instance.ToString();
  return name.empty() ? "nominal" : name;
}

int Estimate::parameters() const {
  std::size_t count = 0;
  for (const EffectInstance& instance : hypothesis.effects) count += instance.parameters.size();
  return static_cast<int>(count);
}

double Estimate::StandardDeviation(Eigen::Index parameter) const {
  return std::sqrt(std::max(0.0, covariance(parameter, parameter)));
}

bool Changes(const EffectInstance& instance, const Nuisance& nuisance) {
  return instance.effect == nuisance.effect && instance.place == nuisance.at;
}

bool ChangesStructure(const EffectInstance& instance) { return instance.effect->info().traits.changes_structure; }

std::vector<double> FreedomOf(const EstimationProblem& problem, const std::vector<EffectInstance>& effects) {
  std::vector<double> freedom;
  const bool wide = std::any_of(effects.begin(), effects.end(), ChangesStructure);
  const Plan changed = problem.PlanOf({std::vector<double>(problem.nuisances().size(), 0.0), effects});
  for (const Nuisance& nuisance : problem.nuisances()) {
    double free = nuisance.start ? 1.0 : wide ? kWide : 1.0;
    if (nuisance.only_wide && !wide) free = 0.0;
    const std::size_t dot = nuisance.path.rfind('.');
    if (changed.root.FindPath(nuisance.path.substr(0, dot)) == nullptr) free = 0.0;
    if (nuisance.relative && changed.root.FindPath(nuisance.path) == nullptr) free = 0.0;
    for (const EffectInstance& instance : effects) {
      if (Changes(instance, nuisance)) free = 0.0;
    }
    freedom.push_back(free);
  }
  return freedom;
}

std::vector<int> FreeOf(const std::vector<double>& freedom) {
  std::vector<int> free;
  for (std::size_t i = 0; i < freedom.size(); ++i) {
    if (freedom[i] > 0.0) free.push_back(static_cast<int>(i));
  }
  return free;
}

Result<NuisanceModel> LineariseNuisances(const EstimationProblem& problem, const Hypothesis& at,
                                         std::vector<double> freedom) {
  NuisanceModel model;
  model.z0 = at.z;
  model.freedom = std::move(freedom);
  model.free = FreeOf(model.freedom);
  std::vector<Eigen::VectorXd> points(model.free.size() + 1);
  std::mutex guard;
  Status failed;
  ParallelFor(points.size(), 0, [&](std::size_t k) {
    Hypothesis moved = at;
    if (k > 0) moved.z[static_cast<std::size_t>(model.free[k - 1])] += kNuisanceStep;
    Result<Eigen::VectorXd> predicted = problem.Predict(moved);
    if (predicted.ok()) {
      points[k] = std::move(*predicted);
    } else {
      const std::lock_guard<std::mutex> lock(guard);
      failed = predicted.failure();
    }
  });
  if (failed) return *failed;
  model.jacobian.resize(problem.measured().size(), static_cast<Eigen::Index>(model.free.size()));
  for (std::size_t k = 0; k < model.free.size(); ++k)
    model.jacobian.col(static_cast<Eigen::Index>(k)) = (points[k + 1] - points[0]) / kNuisanceStep;
  model.predicted = std::move(points[0]);
  return model;
}

namespace {

/// Simulates the hypothesis of a fit; false where it breaks.
bool Run(const EstimationProblem& problem, Estimate& fit) {
  fit.simulations = 1;
  Result<Eigen::VectorXd> predicted = problem.Predict(fit.hypothesis);
  if (!predicted.ok()) {
    fit.broken = predicted.failure().ToString();
  } else if (!predicted->allFinite()) {
    fit.broken = "not finite";
  } else {
    fit.predicted = std::move(*predicted);
  }
  return fit.ok();
}

}  // namespace

Estimate EstimateAt(const EstimationProblem& problem, Hypothesis hypothesis) {
  Estimate fit;
  fit.hypothesis = std::move(hypothesis);
  fit.nuisances.z0 = fit.hypothesis.z;
  fit.nuisances.freedom = FreedomOf(problem, fit.hypothesis.effects);
  fit.nuisances.free = FreeOf(fit.nuisances.freedom);
  Run(problem, fit);
  return fit;
}

void TakeSlopes(const EstimationProblem& from, const NuisanceModel& known, const EstimationProblem& to, Estimate& fit) {
  std::vector<Eigen::Index> columns;
  for (const int i : fit.nuisances.free) {
    const auto at = std::find(known.free.begin(), known.free.end(), i);
    if (at == known.free.end()) return;
    columns.push_back(at - known.free.begin());
  }
  fit.nuisances.jacobian.resize(to.measured().size(), std::ssize(columns));
  for (std::size_t c = 0; c < to.channels().size(); ++c) {
    const Channel &whole = from.channels()[c], &part = to.channels()[c];
    for (Eigen::Index k = 0; k < std::ssize(columns); ++k)
      fit.nuisances.jacobian.col(k).segment(part.begin, part.count) =
          known.jacobian.col(columns[static_cast<std::size_t>(k)]).segment(whole.begin, part.count);
  }
}

Whitener WhitenerOf(const EstimationProblem& problem, const Estimate& fit, int order) {
  return {problem.channels(), problem.measured() - fit.predicted, order};
}

double PriorChi2(const Estimate& fit) {
  double chi2 = 0.0;
  for (const int i : fit.nuisances.free) {
    const auto k = static_cast<std::size_t>(i);
    chi2 += std::pow(fit.hypothesis.z[k] / fit.nuisances.freedom[k], 2);
  }
  return chi2;
}

std::optional<double> AsNuisance(const Nuisance& nuisance, const Estimate& fit) {
  for (const EffectInstance& instance : fit.hypothesis.effects) {
    if (Changes(instance, nuisance)) return DeviateOf(nuisance, instance.parameters.front());
  }
  return std::nullopt;
}

double LargestDeviation(const EstimationProblem& problem, const Estimate& fit) {
  double farthest = 0.0;
  for (const int i : fit.nuisances.free) {
    const auto k = static_cast<std::size_t>(i);
    if (problem.nuisances()[k].start) continue;
    const double deviation = std::abs(fit.hypothesis.z[k]) / fit.nuisances.freedom[k];
    if (std::isnan(deviation)) return deviation;  // std::max would pass over it
    farthest = std::max(farthest, deviation);
  }
  return farthest;
}

Eigen::VectorXd SolverBias(const EstimationProblem& problem, const Estimate& fit) {
  const Eigen::Index parameters = fit.covariance.rows();
  const Result<Eigen::VectorXd> finer = problem.PredictFiner(fit.hypothesis);
  if (!finer.ok()) return Eigen::VectorXd::Zero(parameters);
  const Eigen::VectorXd moved = WhitenerOf(problem, fit)(*finer - fit.predicted);
  return 2.0 * (fit.covariance * (fit.jacobian.transpose() * moved)).cwiseAbs();
}

bool IsNothing(const EstimationProblem& problem, const Estimate& fit, std::size_t effect) {
  const Eigen::VectorXd bias = fit.hypothesis.effects.size() > 1
                                   ? SolverBias(problem, fit)
                                   : Eigen::VectorXd(Eigen::VectorXd::Zero(fit.covariance.rows()));
  Eigen::Index k = 0;
  for (std::size_t e = 0; e < effect; ++e) k += static_cast<Eigen::Index>(fit.hypothesis.effects[e].parameters.size());
  const EffectInstance& instance = fit.hypothesis.effects[effect];
  bool strength = false;
  for (std::size_t i = 0; i < instance.parameters.size(); ++i, ++k) {
    const EffectParameter& p = instance.effect->info().parameters[i];
    if (!std::isfinite(p.neutral)) continue;
    strength = true;
    const double half = kTwoSided95 * fit.StandardDeviation(k) + bias[k];
    if (std::abs(instance.parameters[i] - p.neutral) > half) return false;
  }
  return strength;
}

Estimate Estimator::Evaluate(const std::vector<EffectInstance>& effects, const NuisanceModel& nuisances) const {
  return Evaluate(effects, nuisances, Projection(nuisances, whitener_));
}

Estimate Estimator::Evaluate(const std::vector<EffectInstance>& effects, const NuisanceModel& nuisances,
                             const Projection& projection) const {
  Estimate fit;
  fit.hypothesis = {nuisances.z0, effects};
  fit.nuisances = nuisances;
  if (!Run(problem_, fit)) return fit;
  const Eigen::VectorXd error = whitener_(problem_.measured() - fit.predicted);
  const Eigen::VectorXd shift = projection.Shift(error);
  fit.chi2 = projection.Residual(error, shift).squaredNorm();
  if (shift.size() > 0) fit.predicted += nuisances.jacobian * shift;
  for (std::size_t k = 0; k < nuisances.free.size(); ++k)
    fit.hypothesis.z[static_cast<std::size_t>(nuisances.free[k])] += shift[static_cast<Eigen::Index>(k)];
  fit.log_det = projection.log_det();
  fit.criterion = fit.chi2 + fit.log_det + fit.parameters() * std::log(std::max(2.0, whitener_.rows()));
  return fit;
}

Estimate Estimator::Optimise(const std::vector<EffectInstance>& effects, const NuisanceModel& nuisances,
                             int iterations) const {
  const Coordinates coordinates(effects);
  if (coordinates.size() == 0 || problem_.spent()) return Evaluate(effects, nuisances);
  const Projection projection(nuisances, whitener_);
  std::vector<double> x = coordinates.Start();
  int simulations = 0;
  ceres::Problem problem;
  problem.AddResidualBlock(new FreeRunCost(problem_, whitener_, nuisances, projection, coordinates, &simulations),
                           nullptr, x.data());
  for (std::size_t i = 0; i < coordinates.size(); ++i) {
    problem.SetParameterLowerBound(x.data(), static_cast<int>(i), coordinates.lower(i));
    problem.SetParameterUpperBound(x.data(), static_cast<int>(i), coordinates.upper(i));
  }
  ceres::Solver::Options options;
  options.linear_solver_type = ceres::DENSE_QR;
  options.max_num_iterations = iterations;
  options.function_tolerance = 1e-6;  // of a chi2 of 1e5: 0.1, far below what decides
  options.parameter_tolerance = 1e-7;
  options.logging_type = ceres::SILENT;
  ceres::Solver::Summary summary;
  ceres::Solve(options, &problem, &summary);
  Estimate fit = Evaluate(coordinates.At(x.data()), nuisances, projection);
  fit.simulations += simulations;
  if (!summary.IsSolutionUsable() && fit.ok() && !std::isfinite(fit.chi2)) fit.broken = summary.message;
  return fit;
}

void Estimator::Score(Estimate& fit) const {
  fit.chi2 = whitener_(problem_.measured() - fit.predicted).squaredNorm() + PriorChi2(fit);
  fit.log_det = fit.nuisances.jacobian.size() > 0 ? Projection(fit.nuisances, whitener_).log_det() : 0.0;
  fit.criterion = fit.chi2 + fit.log_det + fit.parameters() * std::log(std::max(2.0, whitener_.rows()));
}

void Estimator::Derive(Estimate& fit) const {
  const Coordinates coordinates(fit.hypothesis.effects);
  const auto p = static_cast<Eigen::Index>(coordinates.size());
  const auto m = static_cast<Eigen::Index>(fit.nuisances.free.size());
  const std::vector<double> x = coordinates.Start();
  fit.jacobian.resize(problem_.measured().size(), p + m);
  std::vector<double> values;
  for (const EffectInstance& instance : fit.hypothesis.effects)
    values.insert(values.end(), instance.parameters.begin(), instance.parameters.end());
  const bool wide = NeedsWideDifferences(fit.hypothesis.effects);
  std::atomic<int> simulations = 1;
  const Result<Eigen::VectorXd> here = problem_.Predict({fit.hypothesis.z, coordinates.At(x.data())});
  ParallelFor(static_cast<std::size_t>(p), 0, [&](std::size_t k) {
    const auto predicted = [&](double by) {
      std::vector<double> at = x;
      at[k] += by;
      return problem_.Predict({fit.hypothesis.z, coordinates.At(at.data())});
    };
    const std::optional<Difference> difference =
        here.ok() ? DifferenceOf(predicted, *here, whitener_, coordinates.Difference(k, x[k]), wide) : std::nullopt;
    Eigen::Ref<Eigen::VectorXd> column = fit.jacobian.col(static_cast<Eigen::Index>(k));
    if (!difference) {
      column.setZero();
      return;
    }
    column = whitener_(difference->change) / (difference->step * coordinates.Slope(k, values[k]));
    simulations += difference->simulations;
  });
  fit.simulations += simulations;
  Eigen::MatrixXd information = Eigen::MatrixXd::Zero(p + m, p + m);
  for (Eigen::Index k = 0; k < m; ++k) fit.jacobian.col(p + k) = whitener_(fit.nuisances.jacobian.col(k));
  information = fit.jacobian.transpose() * fit.jacobian;
  for (Eigen::Index k = 0; k < m; ++k) {
    const double freedom =
        fit.nuisances.freedom[static_cast<std::size_t>(fit.nuisances.free[static_cast<std::size_t>(k)])];
    information(p + k, p + k) += 1.0 / (freedom * freedom);
  }
  // Scaled before it is inverted: parameters differ by ten decades. What the data do not see keeps a huge variance.
  Eigen::VectorXd scale = information.diagonal().array().max(1e-300).rsqrt();
  const Eigen::MatrixXd scaled = scale.asDiagonal() * information * scale.asDiagonal();
  const dense::SymmetricEigen eigen = dense::Symmetric(scaled);
  const Eigen::VectorXd inverse = eigen.values.array().max(1e-14).inverse();
  fit.covariance =
      scale.asDiagonal() * (eigen.vectors * inverse.asDiagonal() * eigen.vectors.transpose()) * scale.asDiagonal();
}

Estimate Converged(const EstimationProblem& problem, Estimate fit) {
  constexpr double kWorthIt = 0.5;  // of chi2
  for (int k = 0; k < 8 && fit.ok() && !problem.spent(); ++k) {
    const Estimator estimator(problem, WhitenerOf(problem, fit));
    estimator.Score(fit);
    const double before = fit.chi2;
    Estimate on = estimator.Refine(fit, 4);
    if (!on.ok() || !(on.chi2 <= before)) break;
    fit = std::move(on);
    if (before - fit.chi2 < kWorthIt) break;
  }
  return fit;
}

}  // namespace dynoproof::identification
