#include "linear/zeros.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <utility>

#include "linear/branches.h"
#include "linear/modes.h"
#include "linear/zero_dynamics.h"

namespace dynoproof::mechanics {
namespace {

using Complex = std::complex<double>;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using Roots = std::vector<Complex>;

constexpr double kCancel = 1e-8;  // relative distance of a zero from the pole it cancels: both are known to about this

Failure NotReached() { return {"the input does not reach the output", "", {}, 2}; }

/// The part of the network that can reach or load the output, with the input and the output counted in it.
struct Plant {
  Network network;
  VectorXd input;
  Output output;
};

/// Nothing for the torque of a shaft that transmits none and joins two parts: it belongs to neither.
std::optional<Plant> PartOfOutput(const Network& network, const VectorXd& input, const Output& output) {
  const bool is_torque = output.kind == OutputKind::kEdgeTorque;
  const std::vector<int> labels = Groups(network, -1, -1);
  const int label = labels[is_torque ? network.edges[output.index].from : output.index];
  const Branch branch = TakeBranch(network, labels, label, CutEdges::kDrop);
  const std::optional<int> index = is_torque ? branch.LocalEdge(output.index) : branch.LocalNode(output.index);
  if (!index) return std::nullopt;
  return Plant{branch.network, branch.Pick(input), {output.kind, *index}};
}

Network WithoutDamping(Network network) {
  for (Edge& edge : network.edges) edge.damping = 0.0;
  return network;
}

void AddShaftRoot(const Edge& edge, Roots& roots) {
  if (edge.damping > 0.0) roots.push_back(-edge.stiffness / edge.damping);
}

Status AddEigenvalues(const Network& network, Roots& roots) {
  const Result<ModalAnalysis> modal = Modes(network);
  if (!modal.ok()) return modal.failure();
  const Roots all = modal->DampedEigenvalues();
  roots.insert(roots.end(), all.begin(), all.end());
  return std::nullopt;
}

/// Labels of the groups that carry input.
std::vector<int> Driven(const std::vector<int>& labels, const VectorXd& input) {
  std::vector<int> driven;
  for (std::size_t i = 0; i < labels.size(); ++i) {
    const bool is_new = std::find(driven.begin(), driven.end(), labels[i]) == driven.end();
    if (input[static_cast<Eigen::Index>(i)] != 0.0 && is_new) driven.push_back(labels[i]);
  }
  return driven;
}

/// Follows the torque back from the angle of a node: where the node has no input of its own and all input arrives
/// through one shaft, Cramer's rule gives N = (k + s c) det(every other branch, clamped at the node) N', N' of the
/// angle at the far end of that shaft with node and shaft taken away. The projection does the rest, and meets the
/// input at once.
Status AngleRoots(Network network, VectorXd input, int node, Roots& roots) {
  while (input[node] == 0.0) {
    const std::vector<int> labels = Groups(network, node, -1);
    const std::vector<int> driven = Driven(labels, input);
    if (driven.empty()) return NotReached();
    if (driven.size() > 1) break;
    std::vector<int> shafts, far_ends;
    for (int e = 0; e < static_cast<int>(network.edges.size()); ++e) {
      const Edge& edge = network.edges[e];
      if (!Transmits(edge) || edge.to == kGround || (edge.from != node && edge.to != node)) continue;
      const int other = edge.from == node ? edge.to : edge.from;
      if (labels[other] != driven[0]) continue;
      shafts.push_back(e);
      far_ends.push_back(other);
    }
    if (shafts.size() != 1) break;
    for (int label = 0; label <= *std::max_element(labels.begin(), labels.end()); ++label) {
      if (label == driven[0]) continue;
      if (Status status = AddEigenvalues(TakeBranch(network, labels, label, CutEdges::kClamp).network, roots)) {
        return status;
      }
    }
    AddShaftRoot(network.edges[shafts[0]], roots);
    Branch next = TakeBranch(network, labels, driven[0], CutEdges::kDrop);
    node = next.LocalNode(far_ends[0]).value();  // its label is that of the branch
    input = next.Pick(input);
    network = std::move(next.network);
  }
  return ProjectedRoots(network, input, {OutputKind::kAngle, node}, roots);
}

/// A shaft that is the only way between its two sides, one of them without input:
/// N = (k + s c) det(the side without input) N(angle at the near end, with the other side cut off).
Status TorqueRoots(const Plant& plant, Roots& roots) {
  const Edge& edge = plant.network.edges[plant.output.index];
  if (!Transmits(edge)) return NotReached();
  if (edge.to == kGround) {
    AddShaftRoot(edge, roots);
    return AngleRoots(plant.network, plant.input, edge.from, roots);
  }
  const std::vector<int> labels = Groups(plant.network, -1, plant.output.index);
  const std::vector<int> driven = Driven(labels, plant.input);
  if (driven.empty()) return NotReached();
  if (labels[edge.from] == labels[edge.to] || driven.size() > 1) {
    return ProjectedRoots(plant.network, plant.input, plant.output, roots);
  }
  const bool from_is_near = labels[edge.from] == driven[0];
  const int near = from_is_near ? edge.from : edge.to, far = from_is_near ? edge.to : edge.from;
  AddShaftRoot(edge, roots);
  if (Status status = AddEigenvalues(TakeBranch(plant.network, labels, labels[far], CutEdges::kDrop).network, roots)) {
    return status;
  }
  const Branch side = TakeBranch(plant.network, labels, labels[near], CutEdges::kDrop);
  return AngleRoots(side.network, side.Pick(plant.input), side.LocalNode(near).value(), roots);
}

Status NumeratorRoots(const Plant& plant, Roots& roots) {
  if (plant.output.kind == OutputKind::kEdgeTorque) return TorqueRoots(plant, roots);
  if (plant.output.kind == OutputKind::kSpeed) roots.push_back(0.0);
  return AngleRoots(plant.network, plant.input, plant.output.index, roots);
}

Zero Describe(Complex s) {
  const double size = std::abs(s);
  return {s, size / (2.0 * std::numbers::pi), size > 0.0 ? -s.real() / size : 0.0, s.imag() > 0.0};
}

}  // namespace

Result<ZeroAnalysis> TransferZeros(const Network& network, const VectorXd& input, const Output& output) {
  const Result<TransferFunction> whole = TransferFunction::Build(network, input, output);
  if (!whole.ok()) return whole.failure();
  const std::optional<Plant> plant = PartOfOutput(network, input, output);
  if (!plant) return NotReached();
  const Result<ModalAnalysis> modal = Modes(plant->network);
  if (!modal.ok()) return modal.failure();
  std::vector<Complex> roots;
  if (Status status = NumeratorRoots(*plant, roots)) return *status;
  std::vector<Complex> poles = modal->DampedEigenvalues();
  // At the origin both are multiple: poles exactly, computed zeros to the root of the machine precision.
  const double at_origin = 1e-7 * std::abs(*std::max_element(poles.begin(), poles.end(), [](Complex a, Complex b) {
                             return std::abs(a) < std::abs(b);
                           }));
  ZeroAnalysis analysis{{}, static_cast<int>(poles.size()) - static_cast<int>(roots.size()), 0};
  for (const Complex& s : roots) {
    const auto meets = [&](Complex p) { return std::abs(p - s) <= (p == 0.0 ? at_origin : kCancel * std::abs(p)); };
    const auto same = std::find_if(poles.begin(), poles.end(), meets);
    if (same != poles.end()) {
      if (*same != 0.0) ++analysis.cancelled;
      poles.erase(same);
      continue;
    }
    if (s.imag() >= 0.0) analysis.zeros.push_back(Describe(s));
  }
  std::sort(analysis.zeros.begin(), analysis.zeros.end(),
            [](const Zero& x, const Zero& y) { return x.frequency_hz < y.frequency_hz; });
  return analysis;
}

Result<int> RelativeDegree(const Network& network, const VectorXd& input, const Output& output) {
  const Result<TransferFunction> whole = TransferFunction::Build(network, input, output);
  if (!whole.ok()) return whole.failure();
  const std::optional<Plant> part = PartOfOutput(WithoutDamping(network), input, output);
  if (!part) return NotReached();
  const Plant& plant = *part;
  const VectorXd root = plant.network.Inertias().cwiseSqrt().cwiseInverse();
  const MatrixXd stiffness = root.asDiagonal() * plant.network.StiffnessMatrix() * root.asDiagonal();
  const VectorXd b = root.cwiseProduct(plant.input);
  const int n = plant.network.size();
  VectorXd v = VectorXd::Zero(n);
  if (output.kind == OutputKind::kEdgeTorque) {
    const Edge& edge = plant.network.edges[plant.output.index];
    if (edge.stiffness <= 0.0) return NotReached();
    v[edge.from] = root[edge.from];
    if (edge.to != kGround) v[edge.to] = -root[edge.to];
  } else {
    v[plant.output.index] = root[plant.output.index];
  }
  MatrixXd basis(n, n);
  for (int i = 0; i < n; ++i) {
    basis.col(i) = v.normalized();
    if (std::abs(basis.col(i).dot(b)) > kDirectTerm * b.norm()) {
      return 2 * (i + 1) - (output.kind == OutputKind::kSpeed ? 1 : 0);
    }
    v = stiffness * basis.col(i);
    const double before = v.norm();
    const auto done = basis.leftCols(i + 1);
    for (int twice = 0; twice < 2; ++twice) v -= done * (done.transpose() * v).eval();
    if (!(v.norm() > 1e-10 * before)) break;  // the space is exhausted: what is left is round-off
  }
  return NotReached();
}

Result<bool> IsFlatOutput(const Network& network, const VectorXd& input, const Output& output) {
  const Result<int> degree = RelativeDegree(network, input, output);
  if (!degree.ok()) return degree.failure();
  const Network part = PartOfOutput(WithoutDamping(network), input, output).value().network;  // it has a degree
  const bool held = std::any_of(part.edges.begin(), part.edges.end(),
                                [](const Edge& edge) { return edge.to == kGround && edge.stiffness > 0.0; });
  int order = 2 * part.size();
  if (!held && output.kind == OutputKind::kEdgeTorque) order -= 2;
  if (!held && output.kind == OutputKind::kSpeed) order -= 1;
  return *degree == order;
}

double CounterOscillatorZero(double k1, double I1) { return std::sqrt(k1 / I1); }

double ProportionalInputZero(double k1, double I1, double I2) { return std::sqrt(k1 * (1.0 / I1 + 1.0 / I2)); }

double SplitInputZero(double k1, double I1, double kappa1, double kappa2) {
  return std::sqrt(k1 / I1 * (kappa1 / kappa2 + 1.0));
}

}  // namespace dynoproof::mechanics
