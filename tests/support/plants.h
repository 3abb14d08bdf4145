// Drive lines of the thesis as networks, for tests and benchmarks that need a real plant without a scenario file.
#pragma once

#include <Eigen/Dense>

#include "linear/network.h"

namespace dynoproof::support {

/// Table A.7, setup 1: the R2R rotor (70 slices) with two inertias: nodes "rotor[1..70]", "I4", "I5"; edges
/// "rotor(..)", "k3", "k4". The shaft torque is that of k4.
inline mechanics::Network SoftRotorR2R(int slices = 70) {
  mechanics::Network network;
  AddSoftRotor(network, {"rotor", 4.813, 8.90e6, 28.4, slices});
  network.nodes.push_back({"I4", 0.137});
  network.nodes.push_back({"I5", 0.081});
  network.edges.push_back({"k3", slices - 1, slices, 5.76e6, 5.5});
  network.edges.push_back({"k4", slices, slices + 1, 6.37e6, 125.1});
  return network;
}

/// The airgap torque of SoftRotorR2R, spread equally over slices 5 to 67 (counted from 1), 72 x 1.
inline Eigen::MatrixXd AirgapR2R() {
  Eigen::MatrixXd weights = Eigen::MatrixXd::Zero(72, 1);
  weights.block(4, 0, 63, 1).setConstant(1.0 / 63.0);
  return weights;
}

/// Table A.1, setup 1: the straight chain of five inertias, its first two shafts strongly damped.
inline mechanics::Network StraightChain() {
  mechanics::Network network;
  network.nodes = {{"I1", 25.082}, {"I2", 6.352}, {"I3", 1.572}, {"I4", 0.159}, {"I5", 0.140}};
  network.edges = {
      {"k1", 0, 1, 60.99e6, 850.4}, {"k2", 1, 2, 17.99e6, 800.0}, {"k3", 2, 3, 3.36e6, 0.0}, {"k4", 3, 4, 6.28e6, 0.0}};
  return network;
}

}  // namespace dynoproof::support
