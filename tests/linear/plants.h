// More drive lines of the thesis' tables and seeded random networks, for the tests of the mechanics layer.
#pragma once

#include <Eigen/Dense>
#include <cmath>
#include <random>
#include <string>

#include "linear/network.h"
#include "tests/support/plants.h"

namespace dynoproof::mechanics {

/// Table A.4, setup 1: the alternative structure, which closes a mesh.
inline Network Alternative() {
  Network n;
  n.nodes = {{"I1", 23.534}, {"I2", 0.285}, {"I3", 0.475}, {"I4", 0.045}, {"I5", 0.198}};
  n.edges = {{"k12", 0, 1, 4.95e6, 1.7},
             {"k13", 0, 2, 8.16e6, 2.3},
             {"k23", 1, 2, 1.00e6, 1.2},
             {"k24", 1, 3, 0.29e6, 1.2},
             {"k25", 1, 4, 10.25e6, 14.5}};
  return n;
}

/// A soft rotor with two lumped inertias; the airgap torque spares some slices at the ends. The last edge is k4.
struct SoftPlant {
  Network network;
  Eigen::VectorXd airgap;
  int k4;
};

inline SoftPlant SoftRotorPlant(const SoftRotor& rotor, Edge k3, double I4, Edge k4, double I5, int first, int last) {
  SoftPlant plant;
  AddSoftRotor(plant.network, rotor);
  const int n = rotor.slices;
  plant.network.nodes.push_back({"I4", I4});
  plant.network.nodes.push_back({"I5", I5});
  k3.from = n - 1, k3.to = n, k4.from = n, k4.to = n + 1;
  plant.network.edges.push_back(k3);
  plant.network.edges.push_back(k4);
  plant.airgap = Eigen::VectorXd::Zero(n + 2);
  plant.airgap.segment(first - 1, last - first + 1).setConstant(1.0 / (last - first + 1));
  plant.k4 = static_cast<int>(plant.network.edges.size()) - 1;
  return plant;
}

/// Table A.5, setup 1: airgap torque on all but the outer five slices of each end.
inline SoftPlant HeavyDuty(int slices = 100) {
  return SoftRotorPlant({"rotor", 25.308, 16.5e6, 85.6, slices}, {"k3", 0, 0, 5.1e6, 18.2}, 0.235,
                        {"k4", 0, 0, 7.99e6, 23.0}, 0.159, 6, slices - 5);
}

/// Table A.7, setup 1: airgap torque on slices 5 to 67 of 70.
inline SoftPlant RoadToRig() { return {support::SoftRotorR2R(), support::AirgapR2R().col(0), 70}; }

using support::StraightChain;

inline double LogUniform(std::mt19937& random, double low, double high) {
  // The distributions of the library differ between implementations; the generator does not.
  return low * std::pow(high / low, static_cast<double>(random()) / 4294967295.0);
}

/// A random tree of n nodes (a chain where `is_chain`) with values as in drive lines and modal damping around 1 %.
inline Network RandomTree(unsigned seed, int n, bool is_chain) {
  std::mt19937 random(seed);
  Network network;
  for (int i = 0; i < n; ++i) network.nodes.push_back({"I" + std::to_string(i), LogUniform(random, 0.05, 20.0)});
  for (int i = 1; i < n; ++i) {
    const int parent = is_chain ? i - 1 : static_cast<int>(random() % static_cast<unsigned>(i));
    const double k = LogUniform(random, 1e5, 5e7);
    network.edges.push_back({"k" + std::to_string(i), parent, i, k, k * LogUniform(random, 1e-6, 1e-5)});
  }
  return network;
}

}  // namespace dynoproof::mechanics
