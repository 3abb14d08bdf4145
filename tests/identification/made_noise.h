// Noise for tests, white and coloured.
#pragma once

#include <Eigen/Dense>
#include <random>

namespace dynoproof::identification {

inline Eigen::VectorXd White(std::mt19937& random, Eigen::Index rows) {
  std::normal_distribution<double> normal;
  return Eigen::VectorXd::NullaryExpr(rows, [&] { return normal(random); });
}

/// y[i] = a y[i-1] + e[i] + b e[i-1].
inline Eigen::VectorXd Coloured(std::mt19937& random, Eigen::Index rows, double a, double b) {
  const Eigen::VectorXd e = White(random, rows);
  Eigen::VectorXd y = e;
  for (Eigen::Index i = 1; i < rows; ++i) y[i] = a * y[i - 1] + e[i] + b * e[i - 1];
  return y;
}

}  // namespace dynoproof::identification
