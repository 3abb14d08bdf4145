#include "plugins/law/hydrodynamic_coupling/oil_coupling.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <unsupported/Eigen/NonLinearOptimization>

namespace dynoproof::mechanics {

DynamicValues OilCoupling::At(double nu) const {
  // Divided by nu or kappa_p first, so that neither limit overflows.
  const double share = nu == 0.0 ? 0.0 : 1.0 / (1.0 + (kappa_p / nu) * (kappa_p / nu));  // nu^2 / (nu^2 + kappa_p^2)
  return {k_s + oil_stiffness() * share, oil_stiffness() / (kappa_p * (1.0 + (nu / kappa_p) * (nu / kappa_p)))};
}

OilCoupling FromGeometry(const OilCouplingGeometry& g) {
  const double viscosity = g.density * g.kinematic_viscosity;
  const double kappa_HP =
      g.width * std::pow(g.gap_height, 3) / (12.0 * viscosity * g.gap_length) * (1.0 - 0.63 * g.gap_height / g.width);
  return {.k_s = g.spring,
          .k_p = g.segments * g.width * (0.5 * g.length * g.length + g.length * g.inner_radius),
          .kappa_p = 2.0 * g.bulk_modulus / g.chamber_volume * kappa_HP,
          .kappa_w = 2.0 * g.bulk_modulus / g.chamber_volume * g.side_area() * g.lever()};
}

OilCouplingValidity CheckValidity(const OilCouplingGeometry& g, double twist, double rate) {
  OilCouplingValidity validity;
  const double travel = g.lever() * twist;
  validity.travel = g.side_area() * travel / g.chamber_volume;
  const double velocity = g.side_area() * g.lever() * rate / (g.width * g.gap_height);
  const double hydraulic_diameter = 2.0 * g.gap_height * g.width / (g.width + g.gap_height);
  validity.reynolds = velocity * hydraulic_diameter / g.kinematic_viscosity;
  const OilCoupling coupling = FromGeometry(g);
  validity.pressure = coupling.kappa_w / coupling.kappa_p * rate;
  validity.density = validity.pressure / g.bulk_modulus;
  if (validity.travel > 0.1) {
    validity.warnings.push_back(
        fmt::format("at {:.3g} rad a chamber loses {:.0f} % of its volume: (4.17) takes that as small", twist,
                    100.0 * validity.travel));
  }
  if (validity.reynolds > 2000.0) {
    validity.warnings.push_back(fmt::format(
        "at {:.3g} rad/s the Reynolds number may reach {:.0f}: beyond 2000 the flow is not laminar as (4.14) needs",
        rate, validity.reynolds));
  }
  if (validity.density > 0.01) {
    validity.warnings.push_back(
        fmt::format("at {:.3g} rad/s the pressure drop may reach {:.3g} Pa, {:.0f} % of the bulk modulus: (4.11) takes "
                    "the density as constant",
                    rate, validity.pressure, 100.0 * validity.density));
  }
  return validity;
}

std::string FaultOf(const CouplingTable& table) {
  const std::size_t rows = table.nu.size();
  if (rows == 0 || table.stiffness.size() != rows || table.damping.size() != rows) {
    return "needs as many stiffnesses and dampings as frequencies, at least one";
  }
  int values = 0;
  for (std::size_t i = 0; i < rows; ++i) {
    if (!(table.nu[i] >= 0.0) || !std::isfinite(table.nu[i])) return fmt::format("row {}: a frequency is >= 0", i + 1);
    if (i > 0 && table.nu[i] <= table.nu[i - 1]) return fmt::format("row {}: the frequencies do not rise", i + 1);
    for (const double value : {table.stiffness[i], table.damping[i]}) {
      if (std::isnan(value)) continue;
      if (!(value > 0.0) || !std::isfinite(value))
        return fmt::format("row {}: stiffness and damping are positive", i + 1);
      ++values;
    }
  }
  return values == 0 ? "gives neither stiffness nor damping" : "";
}

namespace {

double Interpolate(const std::vector<double>& nu, const std::vector<double>& values, double at) {
  std::size_t before = nu.size(), after = nu.size();
  for (std::size_t i = 0; i < nu.size(); ++i) {
    if (std::isnan(values[i])) continue;
    if (nu[i] <= at) before = i;
    if (nu[i] >= at && after == nu.size()) after = i;
  }
  if (before == nu.size() && after == nu.size()) return std::numeric_limits<double>::quiet_NaN();
  if (before == nu.size()) return values[after];
  if (after == nu.size() || after == before) return values[before];
  return values[before] + (values[after] - values[before]) * (at - nu[before]) / (nu[after] - nu[before]);
}

/// One value of a table.
struct Given {
  double nu, value;
  bool is_damping;
  std::size_t row;
};

/// Relative deviations of the model exp(log_values) from the table, and their derivatives.
struct Deviations {
  using Scalar = double;
  using InputType = Eigen::VectorXd;
  using ValueType = Eigen::VectorXd;
  using JacobianType = Eigen::MatrixXd;
  enum { InputsAtCompileTime = Eigen::Dynamic, ValuesAtCompileTime = Eigen::Dynamic };

  std::vector<Given> given;

  int inputs() const { return 3; }
  int values() const { return static_cast<int>(given.size()); }

  int operator()(const Eigen::VectorXd& x, Eigen::VectorXd& deviation) const {
    const OilCoupling model{std::exp(x[0]), 1.0, std::exp(x[2]), std::exp(x[1])};
    for (int i = 0; i < values(); ++i) {
      const DynamicValues at = model.At(given[i].nu);
      deviation[i] = (given[i].is_damping ? at.damping : at.stiffness) / given[i].value - 1.0;
    }
    return 0;
  }

  int df(const Eigen::VectorXd& x, Eigen::MatrixXd& jacobian) const {
    const double k_s = std::exp(x[0]), K = std::exp(x[1]), kappa = std::exp(x[2]);
    for (int i = 0; i < values(); ++i) {
      const auto& [nu, value, is_damping, row] = given[i];
      const double sum = nu * nu + kappa * kappa;
      // k = k_s + K nu^2/sum, c = K kappa/sum; d/dx = value d/dvalue, since x are logarithms.
      const Eigen::Vector3d slope =
          is_damping ? Eigen::Vector3d(0.0, K * kappa / sum, K * kappa * (nu * nu - kappa * kappa) / (sum * sum))
                     : Eigen::Vector3d(k_s, K * nu * nu / sum, -2.0 * K * nu * nu * kappa * kappa / (sum * sum));
      jacobian.row(i) = slope.transpose() / value;
    }
    return 0;
  }
};

/// With kappa_p given the relative deviations are linear in k_s and K.
Eigen::Vector2d BestFor(double kappa, const std::vector<Given>& given) {
  Eigen::MatrixXd rows(given.size(), 2);
  for (std::size_t i = 0; i < given.size(); ++i) {
    const double nu = given[i].nu, sum = nu * nu + kappa * kappa;
    rows(i, 0) = given[i].is_damping ? 0.0 : 1.0;
    rows(i, 1) = given[i].is_damping ? kappa / sum : nu * nu / sum;
    rows.row(i) /= given[i].value;
  }
  return rows.colPivHouseholderQr().solve(Eigen::VectorXd::Ones(rows.rows()));
}

/// Two-sided 95 % quantile of Student's distribution with `freedom` degrees (Cornish-Fisher, 1 % from 3 on).
double Student95(int freedom) {
  const double z = 1.959964, f = freedom;
  return z + (z * z * z + z) / (4.0 * f) + (5.0 * std::pow(z, 5) + 16.0 * z * z * z + 3.0 * z) / (96.0 * f * f);
}

}  // namespace

DynamicValues At(const CouplingTable& table, double nu) {
  return {Interpolate(table.nu, table.stiffness, nu), Interpolate(table.nu, table.damping, nu)};
}

Result<OilCouplingFit> FitOilCoupling(const CouplingTable& table) {
  const auto refuse = [](std::string why) {
    return Failure{.message = std::move(why), .signal = "data sheet", .exit_code = 2};
  };
  if (const std::string fault = FaultOf(table); !fault.empty()) return refuse(fault);
  Deviations deviations;
  for (std::size_t i = 0; i < table.nu.size(); ++i) {
    if (!std::isnan(table.stiffness[i])) deviations.given.push_back({table.nu[i], table.stiffness[i], false, i});
    if (!std::isnan(table.damping[i])) deviations.given.push_back({table.nu[i], table.damping[i], true, i});
  }
  const int values = deviations.values();
  if (values < 4) return refuse(fmt::format("has {} values: three parameters need at least 4", values));

  Eigen::VectorXd x(3), deviation(values);
  double least = std::numeric_limits<double>::infinity();
  const double highest = std::max(table.nu.back(), 1.0);
  for (int i = 0; i < 40; ++i) {
    const double kappa = highest * std::pow(10.0, -3.0 + 5.0 * i / 39.0);
    const Eigen::Vector2d best = BestFor(kappa, deviations.given);
    if (!(best[0] > 0.0) || !(best[1] > 0.0)) continue;
    const Eigen::VectorXd start = Eigen::Vector3d(std::log(best[0]), std::log(best[1]), std::log(kappa));
    deviations(start, deviation);
    if (deviation.squaredNorm() >= least) continue;
    least = deviation.squaredNorm();
    x = start;
  }
  if (!std::isfinite(least)) return refuse("no spring and oil stiffness > 0 come near it");
  Eigen::LevenbergMarquardt<Deviations> solver(deviations);
  solver.parameters.xtol = solver.parameters.ftol = 1e-14;
  solver.parameters.gtol = 0.0;
  solver.parameters.maxfev = 500;
  solver.minimize(x);

  OilCouplingFit fit{std::exp(x[0]), std::exp(x[1]), std::exp(x[2]), {}, {}, {}, 0.0, static_cast<int>(solver.iter)};
  deviations(x, deviation);
  fit.rms = std::sqrt(deviation.squaredNorm() / values);
  fit.stiffness_residual.assign(table.nu.size(), std::numeric_limits<double>::quiet_NaN());
  fit.damping_residual = fit.stiffness_residual;
  for (int i = 0; i < values; ++i) {
    const Given& one = deviations.given[i];
    (one.is_damping ? fit.damping_residual : fit.stiffness_residual)[one.row] = deviation[i];
  }
  Eigen::MatrixXd jacobian(values, 3);
  deviations.df(x, jacobian);
  const Eigen::Matrix3d covariance =
      (jacobian.transpose() * jacobian).inverse() * deviation.squaredNorm() / (values - 3);
  for (int i = 0; i < 3; ++i) fit.interval[i] = Student95(values - 3) * std::sqrt(covariance(i, i)) * std::exp(x[i]);
  return fit;
}

}  // namespace dynoproof::mechanics
