#include "linear/branches.h"

#include <algorithm>

namespace dynoproof::mechanics {
namespace {

std::optional<int> Find(const std::vector<int>& items, int item) {
  const auto found = std::find(items.begin(), items.end(), item);
  if (found == items.end()) return std::nullopt;
  return static_cast<int>(found - items.begin());
}

}  // namespace

std::vector<int> Groups(const Network& network, int skip_node, int skip_edge) {
  // Network::Parts joins by springs: let dampers count as such, and cut what is to be skipped.
  Network joined = network;
  for (int e = 0; e < static_cast<int>(joined.edges.size()); ++e) {
    Edge& edge = joined.edges[e];
    const bool skipped = e == skip_edge || (skip_node >= 0 && (edge.from == skip_node || edge.to == skip_node));
    edge.stiffness = skipped ? 0.0 : edge.stiffness + edge.damping;
  }
  std::vector<int> labels = joined.Parts();
  if (skip_node < 0) return labels;
  const int removed = labels[skip_node];
  for (int& label : labels) label = label == removed ? -1 : label - (label > removed ? 1 : 0);
  return labels;
}

std::optional<int> Branch::LocalNode(int node) const { return Find(nodes, node); }
std::optional<int> Branch::LocalEdge(int edge) const { return Find(edges, edge); }

Eigen::VectorXd Branch::Pick(const Eigen::VectorXd& all) const { return all(nodes); }

Branch TakeBranch(const Network& network, const std::vector<int>& labels, int label, CutEdges cut) {
  Branch branch;
  std::vector<int> local(labels.size(), -1);
  for (int i = 0; i < network.size(); ++i) {
    if (labels[i] != label) continue;
    local[i] = branch.network.size();
    branch.network.nodes.push_back(network.nodes[i]);
    branch.nodes.push_back(i);
  }
  for (int e = 0; e < static_cast<int>(network.edges.size()); ++e) {
    Edge edge = network.edges[e];
    const bool to_ground = edge.to == kGround;
    const int from = local[edge.from], to = to_ground ? -1 : local[edge.to];
    if (from < 0 && to < 0) continue;
    if (!to_ground && (from < 0 || to < 0) && cut == CutEdges::kDrop) continue;
    edge.from = from >= 0 ? from : to;
    edge.to = from >= 0 && to >= 0 ? to : kGround;
    branch.network.edges.push_back(edge);
    branch.edges.push_back(e);
  }
  return branch;
}

}  // namespace dynoproof::mechanics
