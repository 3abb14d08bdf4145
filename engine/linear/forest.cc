#include "linear/forest.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <tuple>
#include <utility>

namespace dynoproof::mechanics {
namespace {

using Complex = std::complex<double>;

/// The plain formula: std::complex guards against overflow that cannot occur at these magnitudes, at ten times the
/// cost.
Complex Inverse(Complex z) { return std::conj(z) / std::norm(z); }

Complex Times(Complex a, Complex b) {
  return {a.real() * b.real() - a.imag() * b.imag(), a.real() * b.imag() + a.imag() * b.real()};
}

/// s^2 / (k + s c), also where k = 0 and s -> 0.
Complex SquareOverKappa(double k, double c, Complex s) {
  return k > 0.0 ? Times(Times(s, s), Inverse(k + s * c)) : s / c;
}

}  // namespace

std::optional<Forest> MakeForest(const Network& network) {
  const int n = network.size();
  std::map<std::pair<int, int>, std::pair<double, double>> joined;
  std::vector<std::vector<int>> neighbours(static_cast<std::size_t>(n));
  std::vector<std::pair<double, double>> ground(static_cast<std::size_t>(n), {0.0, 0.0});
  for (const Edge& edge : network.edges) {
    if (edge.stiffness <= 0.0 && edge.damping <= 0.0) continue;
    if (edge.to == kGround) {
      ground[edge.from].first += edge.stiffness;
      ground[edge.from].second += edge.damping;
      continue;
    }
    auto& sum = joined[std::minmax(edge.from, edge.to)];
    if (sum.first == 0.0 && sum.second == 0.0) {
      neighbours[edge.from].push_back(edge.to);
      neighbours[edge.to].push_back(edge.from);
    }
    sum.first += edge.stiffness;
    sum.second += edge.damping;
  }
  std::vector<int> parent(static_cast<std::size_t>(n), -2), sequence;
  for (int root = 0; root < n; ++root) {
    if (parent[root] != -2) continue;
    parent[root] = -1;
    std::vector<int> stack{root};
    while (!stack.empty()) {
      const int node = stack.back();
      stack.pop_back();
      sequence.push_back(node);
      for (const int next : neighbours[node]) {
        if (next == parent[node]) continue;
        if (parent[next] != -2) return std::nullopt;
        parent[next] = node;
        stack.push_back(next);
      }
    }
  }
  std::reverse(sequence.begin(), sequence.end());
  std::vector<int> position(static_cast<std::size_t>(n));
  for (int i = 0; i < n; ++i) position[sequence[i]] = i;
  Forest forest;
  for (const int node : sequence) {
    ForestNode entry{node, -1, 0.0, 0.0, ground[node].first, ground[node].second};
    if (parent[node] >= 0) {
      entry.parent = position[parent[node]];
      std::tie(entry.stiffness, entry.damping) = joined.at(std::minmax(node, parent[node]));
    }
    forest.order.push_back(entry);
  }
  return forest;
}

// f = product over the nodes of (kappa + s^2 J) for children and s^2 J for roots; a child with pivot p = 1 + s^2
// J/kappa contributes kappa p. Each J carries its derivative J' along.
std::complex<double> LogDerivative(const Forest& forest, const Eigen::VectorXd& inertias, Complex s) {
  const std::size_t n = forest.order.size();
  static thread_local std::vector<Complex> value, slope;
  value.assign(n, 0.0);
  slope.assign(n, 0.0);
  const Complex square = Times(s, s), inverse_s = Inverse(s), inverse_square = Times(inverse_s, inverse_s);
  Complex sum = 0.0;
  for (std::size_t i = 0; i < n; ++i) {
    const ForestNode& node = forest.order[i];
    Complex inertia = value[i] + inertias[node.node], inertia_slope = slope[i];
    if (node.ground_k > 0.0 || node.ground_c > 0.0) {
      // A ground edge adds kappa/s^2 = k/s^2 + c/s.
      inertia += node.ground_k * inverse_square + node.ground_c * inverse_s;
      inertia_slope -= Times(2.0 * node.ground_k * inverse_s + node.ground_c, inverse_square);
    }
    if (node.parent < 0) {
      sum += 2.0 * inverse_s + Times(inertia_slope, Inverse(inertia));
      continue;
    }
    const Complex kappa = node.stiffness + s * node.damping, inverse_kappa = Inverse(kappa);
    const Complex x = Times(Times(square, inertia), inverse_kappa);
    // x' = s^2/kappa J' + 2 s J/kappa - x c/kappa
    const Complex x_slope =
        Times(inverse_kappa, Times(square, inertia_slope) + 2.0 * Times(s, inertia) - x * node.damping);
    Complex pivot = 1.0 + x;
    if (pivot == 0.0) pivot = std::numeric_limits<double>::epsilon();
    const Complex inverse_pivot = Inverse(pivot), growth = Times(x_slope, inverse_pivot);
    sum += growth + node.damping * inverse_kappa;
    value[node.parent] += Times(inertia, inverse_pivot);
    slope[node.parent] += Times(inertia_slope - Times(inertia, growth), inverse_pivot);
  }
  return sum;
}

ForestResponse Respond(const Forest& forest, const Eigen::VectorXd& inertias, const Eigen::VectorXd& load, Complex s) {
  const std::size_t n = forest.order.size();
  std::vector<Complex> inertia(n, 0.0), torque(n, 0.0), inverse_pivot(n, 0.0);
  ForestResponse response{Eigen::VectorXcd::Zero(inertias.size()), Eigen::VectorXcd::Zero(inertias.size()), 1.0};
  for (std::size_t i = 0; i < n; ++i) {
    const ForestNode& node = forest.order[i];
    inertia[i] += inertias[node.node];
    torque[i] += load[node.node];
    if (node.ground_k > 0.0 || node.ground_c > 0.0) {
      inertia[i] += node.ground_k / (s * s) + node.ground_c / s;
    }
    if (node.parent < 0) continue;
    const Complex x = inertia[i] * SquareOverKappa(node.stiffness, node.damping, s);
    response.smallest_pivot = std::min(response.smallest_pivot, std::abs(1.0 + x) / (1.0 + std::abs(x)));
    inverse_pivot[i] = 1.0 / (1.0 + x);
    inertia[node.parent] += inertia[i] * inverse_pivot[i];
    torque[node.parent] += torque[i] * inverse_pivot[i];
  }
  for (std::size_t i = n; i-- > 0;) {
    const ForestNode& node = forest.order[i];
    if (node.parent < 0) {
      response.acceleration[node.node] = torque[i] / inertia[i];
      continue;
    }
    // From J a = load + T and a = a_parent - s^2 T / kappa.
    const Complex parent = response.acceleration[forest.order[node.parent].node];
    const Complex t = (inertia[i] * parent - torque[i]) * inverse_pivot[i];
    response.torque[node.node] = t;
    response.acceleration[node.node] = parent - t * SquareOverKappa(node.stiffness, node.damping, s);
  }
  return response;
}

}  // namespace dynoproof::mechanics
