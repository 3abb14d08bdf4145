// The spectrum of a channel's steps from row to row: what does not end where it began would show in all lines of its
// own.
#pragma once

#include <Eigen/Dense>
#include <cmath>
#include <complex>
#include <numbers>
#include <vector>

#include "score/fft.h"

namespace dynoproof::identification {

/// The transform of the steps with zeros behind them, up to `length` >= rows - 1.
inline std::vector<std::complex<double>> StepLines(const Eigen::Ref<const Eigen::VectorXd>& rows, std::size_t length) {
  std::vector<double> steps(length, 0.0);
  for (Eigen::Index i = 1; i < rows.size(); ++i) steps[static_cast<std::size_t>(i - 1)] = rows[i] - rows[i - 1];
  return score::Fft(steps);
}

/// The power in such a line, `cycles` a row, of white noise with standard deviation `sigma`.
inline double StepNoisePower(Eigen::Index rows, double sigma, double cycles) {
  const double step = 2.0 * std::sin(std::numbers::pi * cycles);
  return static_cast<double>(rows) * sigma * sigma * step * step;
}

}  // namespace dynoproof::identification
