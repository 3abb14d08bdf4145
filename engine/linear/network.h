// A drive line as a network: nodes with inertia, edges with stiffness and damping. The same code serves translational
// networks (mass, N/m, N s/m). Branched and closed meshes are allowed; an edge may end at the fixed ground.
#pragma once

#include <Eigen/Dense>
#include <string>
#include <string_view>
#include <vector>

namespace dynoproof::mechanics {

/// Node index of the fixed ground: an edge with `to == kGround` acts between a node and the inertial frame.
inline constexpr int kGround = -1;

struct Node {
  std::string name;
  double inertia;  // [kg m^2], > 0
};

/// Linear torsional spring and damper: it transmits T = k (phi_from - phi_to) + c (w_from - w_to), which brakes `from`
/// and drives `to`.
struct Edge {
  std::string name;
  int from;
  int to;
  double stiffness = 0.0;  // k [N m/rad], >= 0
  double damping = 0.0;    // c [N m s/rad], >= 0
};

/// The nodes and edges. A soft rotor is several of both (AddSoftRotor).
struct Network {
  std::vector<Node> nodes;
  std::vector<Edge> edges;

  int size() const { return static_cast<int>(nodes.size()); }
  /// Index of the node or edge of that name, or -1.
  int FindNode(std::string_view name) const;
  int FindEdge(std::string_view name) const;

  /// Diagonal of the inertia matrix M, n.
  Eigen::VectorXd Inertias() const;
  /// K and C of M phi'' + C phi' + K phi = torque, n x n, symmetric positive semi-definite.
  Eigen::MatrixXd StiffnessMatrix() const;
  Eigen::MatrixXd DampingMatrix() const;
  /// Incidence of the edges, edges x n: twist = incidence * phi (+1 at `from`, -1 at `to`, ground left out).
  Eigen::MatrixXd Incidence() const;
  /// For each node the number of its connected part, counted from 0 in the order of the nodes. Only edges with
  /// stiffness > 0 connect; the ground connects nothing.
  std::vector<int> Parts() const;
};

/// A distributed ("soft") rotor cut into `slices` equal inertias joined by slices - 1 equal shafts (thesis Sec. 2.3.1,
/// Fig. 2.29): slice inertia I/N, slice stiffness k (N-1), slice damping c (N-1).
struct SoftRotor {
  std::string name;
  double inertia;    // I, total [kg m^2]
  double stiffness;  // k_im, end to end [N m/rad]
  double damping;    // c_im, end to end [N m s/rad]
  int slices;        // N >= 2
};

/// Appends the slices to the network as nodes "<name>[1]" ... "<name>[N]" and edges "<name>(1)" ... "<name>(N-1)";
/// returns the index of the first (leftmost) node.
int AddSoftRotor(Network& network, const SoftRotor& rotor);

}  // namespace dynoproof::mechanics
