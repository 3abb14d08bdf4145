#include "diagnosis/identify.h"

#include <ceres/ceres.h>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "base/random.h"
#include "diagnosis/fit.h"
#include "diagnosis/noise.h"
#include "diagnosis/parallel.h"

namespace dynoproof::diagnosis {
namespace {

// Small beside the width of a sharp resonance, far above the round-off of a free run.
constexpr double kStep = 1e-5;

/// Residuals of all outputs, each over its spread, from the logarithms of value / nominal.
class Cost : public ceres::CostFunction {
 public:
  Cost(const Study& study, const std::vector<std::string>& keys) : study_(study), keys_(keys) {
    set_num_residuals(static_cast<int>(study.measured().size()));
    mutable_parameter_block_sizes()->push_back(static_cast<int>(keys.size()));
  }

  Result<Eigen::VectorXd> Error(const std::vector<double>& x) const {
    Plan plan = study_.plan();
    for (std::size_t i = 0; i < keys_.size(); ++i) {
      Value& value = *plan.root.FindPath(keys_[i]);
      value = Value(value.number() * std::exp(x[i]));
    }
    Result<Eigen::VectorXd> predicted = study_.PredictPlan(plan);
    if (!predicted.ok()) return predicted;
    Eigen::VectorXd error = study_.measured() - *predicted;
    for (const Channel& c : study_.channels()) error.segment(c.begin, c.count) /= std::max(c.spread, 1e-9 * c.nominal);
    return error;
  }

  /// Columns of minus the error's derivative; empty where a run breaks.
  Eigen::MatrixXd Jacobian(const std::vector<double>& x, const Eigen::VectorXd& at) const {
    Eigen::MatrixXd jacobian(at.size(), static_cast<Eigen::Index>(x.size()));
    std::atomic<bool> good = true;
    ParallelFor(x.size(), 0, [&](std::size_t k) {
      std::vector<double> moved = x;
      moved[k] += kStep;
      const Result<Eigen::VectorXd> error = Error(moved);
      if (!error.ok() || !error->allFinite()) {
        good = false;
        return;
      }
      jacobian.col(static_cast<Eigen::Index>(k)) = (*error - at) / kStep;
    });
    return good ? jacobian : Eigen::MatrixXd();
  }

  bool Evaluate(double const* const* parameters, double* residuals, double** jacobians) const override {
    const std::vector<double> x(parameters[0], parameters[0] + keys_.size());
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
  const Study& study_;
  const std::vector<std::string>& keys_;
};

/// Sandwich covariance: the scores of neighbouring samples are correlated where the residual is coloured, so they are
/// summed over blocks that are longer than its memory.
Eigen::MatrixXd Sandwich(const Study& study, const Eigen::MatrixXd& jacobian, const Eigen::VectorXd& error,
                         const Eigen::MatrixXd& inverse) {
  constexpr Eigen::Index kBlocks = 50;
  const Eigen::Index p = jacobian.cols();
  Eigen::MatrixXd meat = Eigen::MatrixXd::Zero(p, p);
  for (const Channel& c : study.channels()) {
    const Eigen::Index blocks = std::min<Eigen::Index>(kBlocks, std::max<Eigen::Index>(1, c.count / 10));
    for (Eigen::Index b = 0; b < blocks; ++b) {
      const Eigen::Index begin = c.begin + c.count * b / blocks, end = c.begin + c.count * (b + 1) / blocks;
      const Eigen::VectorXd score =
          jacobian.middleRows(begin, end - begin).transpose() * error.segment(begin, end - begin);
      meat += score * score.transpose();
    }
  }
  return inverse * meat * inverse;
}

}  // namespace

Result<Identified> Identify(const Plan& plan, const std::vector<MappedRecord>& data, const Registry& registry,
                            const std::vector<std::string>& keys, int starts,
                            const std::function<void(double)>& progress) {
  const Study study(plan, data, registry);
  const Cost cost(study, keys);
  const std::vector<double> zero(keys.size(), 0.0);
  const Result<Eigen::VectorXd> before = cost.Error(zero);
  if (!before.ok()) return before.failure();
  Identified result;
  result.starts = starts;
  const auto channels = static_cast<double>(study.measured().size());
  result.nrmse_before = std::sqrt(before->squaredNorm() / channels);
  std::vector<double> costs, best = zero;
  double lowest = before->squaredNorm() * (1.0 + 1e-12);
  const double bound = std::log(10.0);
  for (int start = 0; start < starts; ++start) {
    progress(static_cast<double>(start) / starts);
    std::vector<double> x = zero;
    for (std::size_t k = 0; start > 0 && k < x.size(); ++k)
      x[k] = 0.1 * (2.0 * RandomUniform(1, static_cast<std::uint64_t>(start), k) - 1.0);
    ceres::Problem problem;
    problem.AddResidualBlock(new Cost(study, keys), nullptr, x.data());
    for (std::size_t k = 0; k < x.size(); ++k) {
      problem.SetParameterLowerBound(x.data(), static_cast<int>(k), -bound);
      problem.SetParameterUpperBound(x.data(), static_cast<int>(k), bound);
    }
    ceres::Solver::Options options;
    options.linear_solver_type = ceres::DENSE_QR;
    options.max_num_iterations = 50;
    options.function_tolerance = 1e-8;
    options.logging_type = ceres::SILENT;
    ceres::Solver::Summary summary;
    ceres::Solve(options, &problem, &summary);
    if (!summary.IsSolutionUsable()) continue;
    costs.push_back(2.0 * summary.final_cost);
    if (costs.back() < lowest) lowest = costs.back(), best = x;
  }
  for (const double one : costs) result.converged += one <= lowest * 1.001 ? 1 : 0;
  const Result<Eigen::VectorXd> error = cost.Error(best);
  if (!error.ok()) return error.failure();
  result.nrmse_after = std::sqrt(error->squaredNorm() / channels);
  const Eigen::MatrixXd jacobian = cost.Jacobian(best, *error);
  if (jacobian.size() == 0) return Failure{"the run breaks beside the optimum", plan.id};
  const Eigen::JacobiSVD<Eigen::MatrixXd> svd(jacobian.transpose() * jacobian, Eigen::ComputeFullV);
  Eigen::VectorXd inverse_values = svd.singularValues();
  // What a change of 100 % moves by less than a tenth of the noise (all samples together) is not seen.
  const double unseen = 0.01 * error->squaredNorm() / channels;
  for (Eigen::Index k = 0; k < inverse_values.size(); ++k) {
    const double value = svd.singularValues()[k];
    result.singular.push_back(std::sqrt(value));
    inverse_values[k] = 1.0 / std::max(value, 1e-300);
    if (value > 1e-9 * svd.singularValues()[0] && value > unseen) continue;
    std::vector<std::string> set;
    for (std::size_t i = 0; i < keys.size(); ++i) {
      if (std::abs(svd.matrixV()(static_cast<Eigen::Index>(i), k)) > 0.1) set.push_back(keys[i]);
    }
    result.alike.push_back(set);
  }
  const Eigen::MatrixXd inverse = svd.matrixV() * inverse_values.asDiagonal() * svd.matrixV().transpose();
  const Eigen::MatrixXd relative = Sandwich(study, jacobian, *error, inverse);
  Eigen::VectorXd values(static_cast<Eigen::Index>(keys.size()));
  for (std::size_t i = 0; i < keys.size(); ++i) {
    const auto k = static_cast<Eigen::Index>(i);
    const double nominal = plan.root.FindPath(keys[i])->number();
    values[k] = nominal * std::exp(best[i]);
    const double half = kTwoSided95 * std::sqrt(std::max(0.0, relative(k, k)));
    const double a = nominal * std::exp(best[i] - half), b = nominal * std::exp(best[i] + half);
    result.values.push_back(
        {keys[i], nominal, values[k], std::min(a, b), std::max(a, b), std::abs(best[i]) > bound * 0.999});
  }
  result.covariance = values.asDiagonal() * relative * values.asDiagonal();
  return result;
}

nlohmann::json ToJson(const Identified& identified) {
  nlohmann::json out = {{"parameters", nlohmann::json::object()},
                        {"covariance", nlohmann::json::array()},
                        {"singular_values", identified.singular},
                        {"not_told_apart", identified.alike},
                        {"starts", identified.starts},
                        {"converged", identified.converged},
                        {"nrmse_before", identified.nrmse_before},
                        {"nrmse_after", identified.nrmse_after}};
  for (const IdentifiedValue& one : identified.values) {
    out["parameters"][one.key] = {{"value", one.value}, {"nominal", one.nominal}, {"ci95", nullptr}};
    if (!one.on_bound) out["parameters"][one.key]["ci95"] = {one.lower, one.upper};
  }
  for (Eigen::Index i = 0; i < identified.covariance.rows(); ++i) {
    out["covariance"].push_back(nlohmann::json::array());
    for (Eigen::Index k = 0; k < identified.covariance.cols(); ++k)
      out["covariance"].back().push_back(identified.covariance(i, k));
  }
  return out;
}

std::string ToTable(const Identified& identified) {
  std::string text = fmt::format("{:<44}{:>14}{:>14}   95 % interval\n", "key", "nominal", "value");
  for (const IdentifiedValue& one : identified.values)
    text += fmt::format("{:<44}{:>14.6g}{:>14.6g}   {}\n", one.key, one.nominal, one.value,
                        one.on_bound ? "on its bound" : fmt::format("{:.6g} ... {:.6g}", one.lower, one.upper));
  for (const auto& set : identified.alike) text += fmt::format("not told apart: {}\n", fmt::join(set, ", "));
  text += fmt::format("NRMSE {:.4g} -> {:.4g}; {} of {} starts reached the best fit\n", identified.nrmse_before,
                      identified.nrmse_after, identified.converged, identified.starts);
  return text;
}

}  // namespace dynoproof::diagnosis
