// Cutting networks: what hangs together when a node or a shaft is taken away.
#pragma once

#include <optional>
#include <vector>

#include "linear/network.h"

namespace dynoproof::mechanics {

/// Whether the edge can transmit any torque.
inline bool Transmits(const Edge& edge) { return edge.stiffness > 0.0 || edge.damping > 0.0; }

/// For each node the number of the group it belongs to, counted from 0 in the order of the nodes: nodes joined by
/// springs or dampers, without `skip_node` (its label is -1) and without `skip_edge`; -1 skips nothing.
std::vector<int> Groups(const Network& network, int skip_node, int skip_edge);

/// The nodes with that label. `nodes` and `edges` map back to the indices of the whole network.
struct Branch {
  Network network;
  std::vector<int> nodes;
  std::vector<int> edges;

  /// Index in the branch of a node or edge of the whole, if it is in the branch. An edge that transmits nothing may
  /// join two branches and be in neither.
  std::optional<int> LocalNode(int node) const;
  std::optional<int> LocalEdge(int edge) const;
  /// The entries of a vector over all nodes that belong to the branch.
  Eigen::VectorXd Pick(const Eigen::VectorXd& all) const;
};

enum class CutEdges { kDrop, kClamp };

/// Takes a branch out. Edges to other nodes are dropped, or end at the ground (the rest of the network held still).
Branch TakeBranch(const Network& network, const std::vector<int>& labels, int label, CutEdges cut);

}  // namespace dynoproof::mechanics
