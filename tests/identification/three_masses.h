// A three-mass line under a chirp: its scenario, and experiments with it that no engine code simulated.
#pragma once

#include <Eigen/Dense>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <string>
#include <vector>

#include "linear/dense.h"

namespace dynoproof::identification {

inline constexpr double kI1 = 2.0, kI2 = 0.3, kI3 = 0.5, kK1 = 4.0e5, kK2 = 2.5e5, kC1 = 8.0, kC2 = 6.0;

/// The scenario, with I3 and k1 as a fit begins: a hundredth off.
inline constexpr const char* kThreeMasses = R"(
title = "line"
[run]
duration_s = 0.6
period_s = 1e-4
[plant]
type = "drive_line"
[plant.inertia]
I1 = 2.0
I2 = 0.3
I3 = 0.505
[plant.shaft.k1]
between = ["I1", "I2"]
stiffness_Nm_per_rad = 3.98e5
damping_Nms_per_rad = 8.0
[plant.shaft.k2]
between = ["I2", "I3"]
stiffness_Nm_per_rad = 2.5e5
damping_Nms_per_rad = 6.0
[plant.torque.T_airgap]
on = "I1"
[input.T_airgap]
to = "plant.T_airgap"
unit = "N m"
nominal = 100.0
source = { type = "chirp", amplitude = 100.0, start_Hz = 0.0, end_Hz = 120.0, rate_Hz_per_s = 200.0 }
[output.T_shaft]
of = "plant.k2.torque"
nominal = 100.0
[output.omega_1]
of = "plant.I1.speed"
nominal = 1.0
)";

/// One row a sample.
struct Rows {
  std::vector<double> t, T_airgap, T_shaft, omega_1;  // s, N m, N m, rad/s
};

/// The line from rest under a torque of one value a step, held over it: by a matrix exponential.
inline Rows RunThreeMasses(const std::vector<double>& torque, double step_s) {
  Eigen::Matrix<double, 6, 6> both = Eigen::Matrix<double, 6, 6>::Zero();  // twists, speeds, and the held torque
  both.topLeftCorner<5, 5>() << 0, 0, 1, -1, 0,                            //
      0, 0, 0, 1, -1,                                                      //
      -kK1 / kI1, 0, -kC1 / kI1, kC1 / kI1, 0,                             //
      kK1 / kI2, -kK2 / kI2, kC1 / kI2, -(kC1 + kC2) / kI2, kC2 / kI2,     //
      0, kK2 / kI3, 0, kC2 / kI3, -kC2 / kI3;
  both(2, 5) = 1.0 / kI1;
  const Eigen::Matrix<double, 6, 6> step = dense::Exponential(Eigen::MatrixXd(both * step_s));
  Eigen::Vector<double, 6> x = Eigen::Vector<double, 6>::Zero();
  Rows rows;
  for (std::size_t i = 0; i < torque.size(); ++i) {
    x[5] = torque[i];
    rows.t.push_back(static_cast<double>(i) * step_s);
    rows.T_airgap.push_back(torque[i]);
    rows.T_shaft.push_back(kK2 * x[1] + kC2 * (x[3] - x[4]));
    rows.omega_1.push_back(x[2]);
    x = step * x;
  }
  return rows;
}

/// A chirp to 120 Hz in 0.6 s [N m]; each value is held over so many steps.
inline std::vector<double> Chirp(std::size_t samples, double step_s, std::size_t hold, double phase = 0.3) {
  std::vector<double> torque;
  for (std::size_t i = 0; i < samples; ++i) {
    const double t = static_cast<double>(i / hold * hold) * step_s;
    torque.push_back(100.0 * std::sin(std::numbers::pi * 200.0 * t * t + phase));
  }
  return torque;
}

}  // namespace dynoproof::identification
