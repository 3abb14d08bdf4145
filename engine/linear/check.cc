#include "linear/check.h"

#include <cmath>

namespace dynoproof::mechanics {
namespace {

Failure Bad(const std::string& name, const std::string& message) { return {message, name, std::nullopt, 2}; }

bool NotNegative(double value) { return std::isfinite(value) && value >= 0.0; }

}  // namespace

Status CheckNetwork(const Network& network) {
  if (network.nodes.empty()) return Bad("", "the network has no node");
  for (const Node& node : network.nodes) {
    if (!(std::isfinite(node.inertia) && node.inertia > 0.0)) return Bad(node.name, "the inertia must be positive");
  }
  for (const Edge& edge : network.edges) {
    if (edge.from < 0 || edge.from >= network.size()) return Bad(edge.name, "the edge starts at no node");
    if (edge.to != kGround && (edge.to < 0 || edge.to >= network.size())) {
      return Bad(edge.name, "the edge ends at no node");
    }
    if (edge.to == edge.from) return Bad(edge.name, "the edge joins a node to itself");
    if (!NotNegative(edge.stiffness)) return Bad(edge.name, "the stiffness must not be negative");
    if (!NotNegative(edge.damping)) return Bad(edge.name, "the damping must not be negative");
  }
  return std::nullopt;
}

}  // namespace dynoproof::mechanics
