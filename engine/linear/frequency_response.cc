#include "linear/frequency_response.h"

#include <Eigen/SparseLU>
#include <algorithm>
#include <boost/math/tools/minima.hpp>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

#include "linear/check.h"
#include "linear/modes.h"

namespace dynoproof::mechanics {
namespace {

using Complex = std::complex<double>;

constexpr double kTwoPi = 2.0 * std::numbers::pi;
// Below this pivot the tree recursion has lost about three digits: the sparse factorisation takes over.
constexpr double kSmallPivot = 1e-3;
constexpr double kUndamped = 1e-9;

/// Sorted grid for the search: background points, and for each pole points at geometric distances on both sides.
std::vector<double> SearchGrid(const std::vector<Complex>& poles, double from_hz, double to_hz) {
  std::vector<double> grid{from_hz, to_hz};
  const int background = 400;
  for (int i = 1; i < background; ++i) grid.push_back(from_hz + (to_hz - from_hz) * i / background);
  for (const Complex& pole : poles) {
    const double center = pole.imag() / kTwoPi;
    // An undamped pole still needs a neighbourhood to stand out from.
    const double width = std::max(std::abs(pole.real()), 1e-7 * std::abs(pole)) / kTwoPi;
    if (center <= 0.0) continue;
    grid.push_back(center);
    for (double step = 0.125 * width; step < to_hz - from_hz; step *= 1.4) {
      grid.push_back(center - step);
      grid.push_back(center + step);
    }
  }
  std::erase_if(grid, [&](double f) { return !(f >= from_hz && f <= to_hz); });
  std::sort(grid.begin(), grid.end());
  grid.erase(std::unique(grid.begin(), grid.end()), grid.end());
  return grid;
}

}  // namespace

TransferFunction::TransferFunction(Network network, Eigen::VectorXd input, Output output)
    : network_(std::move(network)),
      input_(std::move(input)),
      output_(output),
      inertias_(network_.Inertias()),
      forest_(MakeForest(network_)) {}

Result<TransferFunction> TransferFunction::Build(const Network& network, const Eigen::VectorXd& input,
                                                 const Output& output) {
  if (Status status = CheckNetwork(network)) return *status;
  if (input.size() != network.size()) return Failure{"the input needs one weight for each node", "", {}, 2};
  if (!input.allFinite()) return Failure{"an input weight is not finite", "", {}, 2};
  const int limit = output.kind == OutputKind::kEdgeTorque ? static_cast<int>(network.edges.size()) : network.size();
  if (output.index < 0 || output.index >= limit) return Failure{"the output does not exist", "", {}, 2};
  return TransferFunction(network, input, output);
}

Complex TransferFunction::Pick(const Eigen::VectorXcd& acceleration, Complex s) const {
  const Complex a = acceleration[output_.index];
  return output_.kind == OutputKind::kSpeed ? a / s : a / (s * s);
}

Complex TransferFunction::At(Complex s) const {
  const bool is_torque = output_.kind == OutputKind::kEdgeTorque;
  // The recursion knows the torque of all edges between two nodes together, and none of those to the ground.
  const Edge* edge = is_torque ? &network_.edges[output_.index] : nullptr;
  if (!forest_ || s == 0.0 || (edge != nullptr && edge->to == kGround)) return BySparseLu(s);
  const ForestResponse response = Respond(*forest_, inertias_, input_, s);
  if (!(response.smallest_pivot > kSmallPivot)) return BySparseLu(s);
  if (!is_torque) return Pick(response.acceleration, s);
  if (edge->stiffness <= 0.0 && edge->damping <= 0.0) return 0.0;
  for (const ForestNode& node : forest_->order) {
    if (node.parent < 0) continue;
    const int above = forest_->order[node.parent].node;
    if (std::minmax(node.node, above) != std::minmax(edge->from, edge->to)) continue;
    // The torque on the child comes from the parent; an edge's torque drives its `to`.
    const Complex torque = (node.node == edge->to ? 1.0 : -1.0) * response.torque[node.node];
    if (node.stiffness == edge->stiffness && node.damping == edge->damping) return torque;
    return torque * (edge->stiffness + s * edge->damping) / (node.stiffness + s * node.damping);
  }
  return BySparseLu(s);
}

// M a + B^T T = b and B a - D T = 0 with D = s^2 / kappa: accelerations and shaft torques are both unknowns, so that
// nothing is subtracted in a free network at small s, where a stays, T stays and D vanishes.
Complex TransferFunction::BySparseLu(Complex s) const {
  const int n = network_.size(), edges = static_cast<int>(network_.edges.size());
  std::vector<Eigen::Triplet<Complex>> entries;
  // Torques are scaled by the mean inertia to bring both kinds of rows to one magnitude.
  const double scale = inertias_.mean();
  for (int i = 0; i < n; ++i) entries.emplace_back(i, i, inertias_[i] / scale);
  for (int e = 0; e < edges; ++e) {
    const Edge& edge = network_.edges[e];
    if (edge.stiffness <= 0.0 && edge.damping <= 0.0) {
      entries.emplace_back(n + e, n + e, 1.0);
      continue;
    }
    entries.emplace_back(edge.from, n + e, 1.0);
    entries.emplace_back(n + e, edge.from, 1.0);
    if (edge.to != kGround) {
      entries.emplace_back(edge.to, n + e, -1.0);
      entries.emplace_back(n + e, edge.to, -1.0);
    }
    const Complex d = edge.stiffness > 0.0 ? s * s / (edge.stiffness + s * edge.damping) : s / edge.damping;
    entries.emplace_back(n + e, n + e, -d * scale);
  }
  Eigen::SparseMatrix<Complex> matrix(n + edges, n + edges);
  matrix.setFromTriplets(entries.begin(), entries.end());
  const Eigen::SparseLU<Eigen::SparseMatrix<Complex>> lu(matrix);
  if (lu.info() != Eigen::Success) return std::numeric_limits<double>::quiet_NaN();
  Eigen::VectorXcd right = Eigen::VectorXcd::Zero(n + edges);
  right.head(n) = input_.cast<Complex>() / scale;
  const Eigen::VectorXcd solution = lu.solve(right);
  if (output_.kind != OutputKind::kEdgeTorque) return Pick(solution, s);
  return solution[n + output_.index] * scale;
}

Complex TransferFunction::AtFrequency(double frequency_hz) const { return At({0.0, kTwoPi * frequency_hz}); }

Eigen::VectorXcd TransferFunction::AtFrequencies(const Eigen::VectorXd& frequencies_hz) const {
  Eigen::VectorXcd values(frequencies_hz.size());
  for (Eigen::Index i = 0; i < values.size(); ++i) values[i] = AtFrequency(frequencies_hz[i]);
  return values;
}

Result<std::vector<Resonance>> PracticalResonances(const TransferFunction& transfer, double from_hz, double to_hz) {
  if (!(from_hz >= 0.0 && to_hz > from_hz && std::isfinite(to_hz))) {
    return Failure{"the range of frequencies is empty", "", {}, 2};
  }
  const Result<ModalAnalysis> modal = Modes(transfer.network());
  if (!modal.ok()) return modal.failure();
  const std::vector<Complex> poles = modal->DampedEigenvalues();
  const std::vector<double> grid = SearchGrid(poles, from_hz, to_hz);
  // Undamped poles that the grid meets exactly count as a very high gain; a NaN must not hide its neighbours.
  const auto level = [&](double f) {
    const double gain = std::log(std::abs(transfer.AtFrequency(f)));
    return std::isfinite(gain) ? -gain : (gain < 0.0 ? 1e3 : -1e3);
  };
  std::vector<double> values(grid.size());
  for (std::size_t i = 0; i < grid.size(); ++i) values[i] = level(grid[i]);
  std::vector<Resonance> found;
  for (std::size_t i = 1; i + 1 < grid.size(); ++i) {
    if (!(values[i] < values[i - 1] && values[i] <= values[i + 1])) continue;
    const auto [f, low] = boost::math::tools::brent_find_minima(level, grid[i - 1], grid[i + 1], 40);
    bool unbounded = false;
    for (const Complex& pole : poles) {
      const bool near = std::abs(pole.imag() / kTwoPi - f) <= 1e-6 * f;
      if (near && std::abs(pole.real()) <= kUndamped * std::abs(pole)) {
        found.push_back({pole.imag() / kTwoPi, std::exp(-low), true});
        unbounded = true;
        break;
      }
    }
    if (!unbounded) found.push_back({f, std::exp(-low), false});
  }
  return found;
}

}  // namespace dynoproof::mechanics
