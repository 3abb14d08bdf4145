#include "thesis/pressure_loops.h"

#include <cmath>
#include <limits>

#include "thesis/speed_loop.h"

namespace dynoproof::mechanics {
namespace {

Eigen::VectorXd Coefficients(std::initializer_list<double> values) {
  Eigen::VectorXd all(static_cast<Eigen::Index>(values.size()));
  std::copy(values.begin(), values.end(), all.begin());
  return all;
}

/// b of (6.30): what a unit of p_mem does to the third derivative of p_g.
double LoopGain(const Regulator& r) { return r.A / r.m * r.k_q * r.pressure_rate; }

}  // namespace

TransferPolynomials VolumeLoop(double capacity, const PiGains& gains, double outflow) {
  return {Coefficients({gains.k_P + gains.k_F, gains.k_I}), Coefficients({capacity, gains.k_P + outflow, gains.k_I})};
}

Eigen::VectorXd RegulatorPolynomial(const Regulator& r) {
  return Coefficients({1.0, r.c_s / r.m, r.k_s / r.m, LoopGain(r)});
}

TransferPolynomials RegulatorLoop(const Regulator& r, const PiGains& gains) {
  const double b = LoopGain(r);
  return {Coefficients({(gains.k_F + gains.k_P) * b, gains.k_I * b}),
          Coefficients({1.0, r.c_s / r.m, r.k_s / r.m, (1.0 + gains.k_P) * b, gains.k_I * b})};
}

double LeastStiffness(const Regulator& r) { return r.A * r.k_q * r.pressure_rate * r.m / r.c_s; }

double LargestProportionalGain(const Regulator& r) { return r.k_s / LeastStiffness(r) - 1.0; }

double LargestIntegralGain(const Regulator& r, double k_P) {
  return (r.k_s - LeastStiffness(r) * (1.0 + k_P)) / r.c_s * (1.0 + k_P);
}

double LargestRealPart(const Eigen::VectorXd& polynomial) {
  const auto roots = PolynomialRoots(polynomial);
  return roots.ok() && roots->size() > 0 ? roots->real().maxCoeff() : std::numeric_limits<double>::quiet_NaN();
}

}  // namespace dynoproof::mechanics
