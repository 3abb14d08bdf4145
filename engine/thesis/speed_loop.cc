#include "thesis/speed_loop.h"

#include <cmath>
#include <limits>

#include "linear/dense.h"

namespace dynoproof::mechanics {
namespace {

using Complex = std::complex<double>;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// Without leading zeros, monic, s in units that make the trailing coefficient +-1; empty when that cannot be done.
VectorXd Normalised(const VectorXd& coefficients, double* unit = nullptr) {
  Eigen::Index first = 0;
  while (first < coefficients.size() && coefficients[first] == 0.0) ++first;
  if (first == coefficients.size() || !coefficients.allFinite()) return {};
  VectorXd p = coefficients.tail(coefficients.size() - first) / coefficients[first];
  const Eigen::Index n = p.size() - 1;
  double scale = 1.0;
  if (n > 0 && p[n] != 0.0) scale = std::pow(std::abs(p[n]), 1.0 / static_cast<double>(n));
  for (Eigen::Index i = 1; i <= n; ++i) p[i] /= std::pow(scale, static_cast<double>(i));
  if (unit != nullptr) *unit = scale;
  return p;
}

}  // namespace

Complex ShaftTorqueTransfer(const TwoMass& p, Complex s) {
  const double m = InverseInertia(p);
  return (p.c * s + p.k) / (p.I1 * (s * s + p.c * m * s + p.k * m));
}

Complex SpeedTransfer(const TwoMass& p, Complex s) {
  const double m = InverseInertia(p);
  return (s * s + (p.c * s + p.k) / p.I2) / (p.I1 * s * (s * s + p.c * m * s + p.k * m));
}

ClosedLoop CloseLoop(const SpeedLoop& loop) {
  const auto& [I1, I2, k, c] = loop.plant;
  const double m = InverseInertia(loop.plant), k_P = loop.k_P, k_I = loop.k_I, k_V = loop.k_V, tau = loop.tau_a;
  ClosedLoop g{VectorXd(4), VectorXd(6)};
  const double s1 = k_P * k / I2 + k_I * c / I2, s0 = k_I * k / I2;
  g.numerator << k_P, k_P * c / I2 + k_I, s1, s0;
  g.denominator << I1 * tau, I1 + I1 * c * m * tau, I1 * c * m + I1 * k * m * tau - k_V * c + k_P,
      I1 * k * m - k_V * k + k_P * c / I2 + k_I, s1, s0;
  return g;
}

Complex ClosedLoopTransfer(const SpeedLoop& loop, Complex s) {
  const Complex p1 = ShaftTorqueTransfer(loop.plant, s), p2 = SpeedTransfer(loop.plant, s);
  const Complex actuator = 1.0 / (s * loop.tau_a + 1.0), controller = loop.k_P + loop.k_I / s;
  return p2 * actuator * controller / (1.0 - loop.k_V * actuator * p1 + actuator * controller * p2);
}

double FeedthroughBound(const SpeedLoop& loop) {
  const TwoMass& p = loop.plant;
  return p.I1 * InverseInertia(p) + loop.k_P * p.c / (p.k * p.I2) + loop.k_I / p.k;
}

double FeedthroughBoundFromDamping(const SpeedLoop& loop) {
  const TwoMass& p = loop.plant;
  if (p.c <= 0.0) return std::numeric_limits<double>::infinity();
  return p.I1 * InverseInertia(p) * (1.0 + p.k * loop.tau_a / p.c) + loop.k_P / p.c;
}

Complex Evaluate(const VectorXd& coefficients, Complex s) {
  Complex value = 0.0;
  for (const double a : coefficients) value = value * s + a;
  return value;
}

Result<Eigen::VectorXcd> PolynomialRoots(const VectorXd& coefficients) {
  double unit = 1.0;
  const VectorXd p = Normalised(coefficients, &unit);
  const Eigen::Index n = p.size() - 1;
  if (n < 1) return Failure{"a polynomial needs a degree of at least 1 and finite coefficients", "", {}, 2};
  MatrixXd companion = MatrixXd::Zero(n, n);
  companion.row(0) = -p.tail(n).transpose();
  companion.diagonal(-1).setOnes();
  // Balance: powers of two that bring row and column norms together, Eigen's solver does not.
  for (bool changed = true; changed;) {
    changed = false;
    for (Eigen::Index i = 0; i < n; ++i) {
      const double row = companion.row(i).norm(), column = companion.col(i).norm();
      if (row == 0.0 || column == 0.0) continue;
      const double factor = std::exp2(std::round(0.5 * std::log2(row / column)));
      if (factor == 1.0) continue;
      companion.col(i) *= factor;
      companion.row(i) /= factor;
      if (companion.row(i).norm() + companion.col(i).norm() < 0.95 * (row + column)) changed = true;
    }
  }
  const Eigen::VectorXcd values = dense::Eigenvalues(companion);
  if (!values.allFinite()) return Failure{"the eigenvalue iteration did not converge", "", {}, 3};
  return Eigen::VectorXcd(values * unit);
}

VectorXd HurwitzDeterminants(const VectorXd& coefficients) {
  const VectorXd p = Normalised(coefficients);
  const Eigen::Index n = p.size() - 1;
  if (n < 1 || p[n] == 0.0) return {};
  // Row i, column j holds a_(2j - i) with a_0 = 1 the leading coefficient (both counted from 1).
  MatrixXd h = MatrixXd::Zero(n, n);
  for (Eigen::Index i = 1; i <= n; ++i) {
    for (Eigen::Index j = 1; j <= n; ++j) {
      const Eigen::Index index = 2 * j - i;
      if (index >= 0 && index <= n) h(i - 1, j - 1) = p[index];
    }
  }
  VectorXd determinants(n);
  for (Eigen::Index size = 1; size <= n; ++size) determinants[size - 1] = h.topLeftCorner(size, size).determinant();
  return determinants;
}

bool IsHurwitz(const VectorXd& coefficients) {
  const VectorXd p = Normalised(coefficients);
  if (p.size() == 0) return false;
  const Eigen::Index n = p.size() - 1, width = n / 2 + 1;
  VectorXd above = VectorXd::Zero(width), row = VectorXd::Zero(width);
  for (Eigen::Index i = 0; i <= n; ++i) (i % 2 == 0 ? above : row)[i / 2] = p[i];
  // One row for each degree; the first column must stay positive. A zero there means roots on the axis or right of it.
  for (Eigen::Index degree = n; degree > 0; --degree) {
    if (!(row[0] > 0.0)) return false;
    VectorXd below = VectorXd::Zero(width);
    for (Eigen::Index j = 0; j + 1 < width; ++j) below[j] = above[j + 1] - above[0] / row[0] * row[j + 1];
    above = row;
    row = below;
  }
  return true;
}

}  // namespace dynoproof::mechanics
