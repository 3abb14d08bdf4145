// Signals of records that are made in a test.
#pragma once

#include <Eigen/Dense>
#include <cmath>
#include <cstdint>
#include <memory>
#include <utility>
#include <vector>

#include "base/random.h"

namespace dynoproof::identification {

inline std::shared_ptr<const std::vector<double>> Shared(std::vector<double> values) {
  return std::make_shared<const std::vector<double>>(std::move(values));
}

/// The signal with white noise of `share` of its spread; `stream` picks the noise.
inline std::shared_ptr<const std::vector<double>> Noisy(std::vector<double> values, double share,
                                                        std::uint64_t stream) {
  const Eigen::Map<const Eigen::ArrayXd> rows(values.data(), static_cast<Eigen::Index>(values.size()));
  const double sigma = share * std::sqrt((rows - rows.mean()).square().mean());
  for (std::size_t i = 0; i < values.size(); ++i) values[i] += sigma * RandomNormal(5, stream, i);
  return Shared(std::move(values));
}

/// Air gap torques without a colour [N m].
inline std::vector<double> RandomTorque(std::size_t rows) {
  std::vector<double> torque;
  for (std::uint64_t i = 0; i < rows; ++i) torque.push_back(300.0 * RandomNormal(5, 1, i));
  return torque;
}

/// Time stamps at 10 kHz [s].
inline std::vector<double> Times(std::size_t rows) {
  std::vector<double> time;
  for (std::size_t i = 0; i < rows; ++i) time.push_back(1e-4 * static_cast<double>(i));
  return time;
}

}  // namespace dynoproof::identification
