// A drive line without meshes as rooted trees: what frequency responses and damped eigenvalues need to work through a
// network from the leaves to the root in one pass.
//
// A subtree shows itself to its parent as an effective inertia. With J the one at a child and the edge's
// kappa = k + s c, the twist is s^2-free: J a = kappa (phi_p - phi_c), a the child's angular acceleration, so the
// parent feels J / (1 + s^2 J / kappa). Neither stiffnesses nor large angles are ever subtracted from each other, hence
// the pass stays exact down to s = 0, where M s^2 + C s + K is singular.
#pragma once

#include <complex>
#include <optional>
#include <vector>

#include "linear/network.h"

namespace dynoproof::mechanics {

/// One node's place in its tree.
struct ForestNode {
  int node;                   // index in the network
  int parent;                 // position in Forest::order of the parent, -1 for a root
  double stiffness, damping;  // k, c of all edges to the parent, together
  double ground_k, ground_c;  // k, c of all edges to the ground, together
};

/// Children before their parents; one root for each part joined by stiffness or damping.
struct Forest {
  std::vector<ForestNode> order;
};

/// The network as a forest, or nothing when edges (with stiffness or damping) close a mesh. Parallel edges count as
/// one.
std::optional<Forest> MakeForest(const Network& network);

/// The logarithmic derivative f'/f at s of f(s) = det(s^2 M + s C + K), in one pass.
std::complex<double> LogDerivative(const Forest& forest, const Eigen::VectorXd& inertias, std::complex<double> s);

/// The angular accelerations s^2 phi of all nodes under the torques `load` [N m], and the smallest pivot
/// abs(1 + x) / (1 + abs(x)) met: digits are lost where it is small (a clamped subtree in undamped resonance).
struct ForestResponse {
  Eigen::VectorXcd acceleration;  // [rad/s^2]
  Eigen::VectorXcd torque;        // by network node: torque from the parent on it [N m], 0 for roots
  double smallest_pivot;
};
ForestResponse Respond(const Forest& forest, const Eigen::VectorXd& inertias, const Eigen::VectorXd& load,
                       std::complex<double> s);

}  // namespace dynoproof::mechanics
