#include "linear/network.h"

#include <cassert>
#include <numeric>

namespace dynoproof::mechanics {
namespace {

template <class Items>
int FindByName(const Items& items, std::string_view name) {
  for (std::size_t i = 0; i < items.size(); ++i) {
    if (items[i].name == name) return static_cast<int>(i);
  }
  return -1;
}

/// Adds the 2 x 2 contribution of one edge to a symmetric n x n matrix.
void Stamp(Eigen::MatrixXd& matrix, const Edge& edge, double value) {
  matrix(edge.from, edge.from) += value;
  if (edge.to == kGround) return;
  matrix(edge.to, edge.to) += value;
  matrix(edge.from, edge.to) -= value;
  matrix(edge.to, edge.from) -= value;
}

}  // namespace

int Network::FindNode(std::string_view name) const { return FindByName(nodes, name); }
int Network::FindEdge(std::string_view name) const { return FindByName(edges, name); }

Eigen::VectorXd Network::Inertias() const {
  Eigen::VectorXd inertias(size());
  for (int i = 0; i < size(); ++i) inertias[i] = nodes[i].inertia;
  return inertias;
}

Eigen::MatrixXd Network::StiffnessMatrix() const {
  Eigen::MatrixXd matrix = Eigen::MatrixXd::Zero(size(), size());
  for (const Edge& edge : edges) Stamp(matrix, edge, edge.stiffness);
  return matrix;
}

Eigen::MatrixXd Network::DampingMatrix() const {
  Eigen::MatrixXd matrix = Eigen::MatrixXd::Zero(size(), size());
  for (const Edge& edge : edges) Stamp(matrix, edge, edge.damping);
  return matrix;
}

Eigen::MatrixXd Network::Incidence() const {
  Eigen::MatrixXd matrix = Eigen::MatrixXd::Zero(static_cast<int>(edges.size()), size());
  for (std::size_t e = 0; e < edges.size(); ++e) {
    matrix(static_cast<int>(e), edges[e].from) = 1.0;
    if (edges[e].to != kGround) matrix(static_cast<int>(e), edges[e].to) = -1.0;
  }
  return matrix;
}

std::vector<int> Network::Parts() const {
  std::vector<int> root(nodes.size());
  std::iota(root.begin(), root.end(), 0);
  const auto find = [&root](int i) {
    while (root[i] != i) i = root[i] = root[root[i]];
    return i;
  };
  for (const Edge& edge : edges) {
    if (edge.to == kGround || edge.stiffness <= 0.0) continue;
    root[find(edge.to)] = find(edge.from);
  }
  std::vector<int> number(nodes.size(), -1), part(nodes.size());
  int count = 0;
  for (int i = 0; i < size(); ++i) {
    int& label = number[find(i)];
    if (label < 0) label = count++;
    part[i] = label;
  }
  return part;
}

int AddSoftRotor(Network& network, const SoftRotor& rotor) {
  assert(rotor.slices >= 2);
  const int first = network.size();
  for (int i = 1; i <= rotor.slices; ++i) {
    network.nodes.push_back({rotor.name + "[" + std::to_string(i) + "]", rotor.inertia / rotor.slices});
  }
  for (int i = 1; i < rotor.slices; ++i) {
    network.edges.push_back({rotor.name + "(" + std::to_string(i) + ")", first + i - 1, first + i,
                             rotor.stiffness * (rotor.slices - 1), rotor.damping * (rotor.slices - 1)});
  }
  return first;
}

}  // namespace dynoproof::mechanics
