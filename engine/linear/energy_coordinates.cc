#include "linear/energy_coordinates.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <list>
#include <memory>
#include <mutex>
#include <numeric>
#include <utility>

#include "linear/dense.h"
#include "linear/low_modes.h"
#include "linear/matrix_product.h"

namespace dynoproof::mechanics {
namespace {

using Eigen::MatrixXd;
using Eigen::RowVectorXd;
using Eigen::VectorXd;

Status Check(const Network& network, const MatrixXd& torque_weights) {
  const auto fault = [](std::string message, std::string signal) {
    return Failure{std::move(message), std::move(signal), {}, 2};
  };
  if (network.size() == 0) return fault("a network needs at least one inertia", "network");
  if (torque_weights.rows() != network.size() || !torque_weights.allFinite()) {
    return fault("torque weights: one finite row per inertia expected", "network");
  }
  for (const Node& node : network.nodes) {
    if (!(node.inertia > 0.0) || !std::isfinite(node.inertia)) return fault("inertia must be positive", node.name);
  }
  for (const Edge& edge : network.edges) {
    const bool ends_exist = edge.from >= 0 && edge.from < network.size() && edge.to >= kGround &&
                            edge.to < network.size() && edge.from != edge.to;
    if (!ends_exist) return fault("an edge must join two different inertias, or one and the ground", edge.name);
    const bool values =
        edge.stiffness >= 0.0 && std::isfinite(edge.stiffness) && edge.damping >= 0.0 && std::isfinite(edge.damping);
    if (!values) return fault("stiffness and damping must be finite and not negative", edge.name);
  }
  return std::nullopt;
}

constexpr Eigen::Index kManyNodes = 20;

/// The decomposition of a network's springs. Those of large networks that were asked for last are remembered: whoever
/// changes a damping, a load or a sensor of a machine builds its network anew, but not its modes.
std::shared_ptr<const dense::Svd> Decomposed(const MatrixXd& strain_of_node) {
  const auto decompose = [&] { return std::make_shared<const dense::Svd>(dense::DividedSvd(strain_of_node)); };
  if (strain_of_node.cols() < kManyNodes) return decompose();
  constexpr std::size_t kKept = 16;
  static std::mutex guard;
  static std::list<std::pair<MatrixXd, std::shared_ptr<const dense::Svd>>> known;  // last asked for first
  const auto find = [&] {
    const auto one = std::find_if(known.begin(), known.end(), [&](const auto& entry) {
      return entry.first.rows() == strain_of_node.rows() && entry.first.cols() == strain_of_node.cols() &&
             entry.first == strain_of_node;
    });
    if (one != known.end()) known.splice(known.begin(), known, one);
    return one != known.end();
  };
  {
    const std::lock_guard<std::mutex> lock(guard);
    if (find()) return known.front().second;
  }
  std::shared_ptr<const dense::Svd> svd = decompose();  // others go on meanwhile
  const std::lock_guard<std::mutex> lock(guard);
  if (!find()) known.emplace_front(strain_of_node, std::move(svd));
  if (known.size() > kKept) known.pop_back();
  return known.front().second;
}

}  // namespace

Result<EnergyCoordinates> EnergyCoordinates::Build(const Network& network, const MatrixXd& torque_weights,
                                                   const Kept& kept) {
  if (Status fault = Check(network, torque_weights)) return *fault;
  EnergyCoordinates result;
  result.network_ = network;
  result.torque_weights_ = torque_weights;
  result.FindModes(kept);
  return result;
}

// The singular values of sqrt(k) * incidence * M^-1/2 are the frequencies themselves. Its SVD keeps a low one exact to
// round-off of the highest; the eigenvalues of K would keep only its square. The left vectors give the twists for free.
void EnergyCoordinates::FindModes(const Kept& kept) {
  const int nodes = network_.size(), edges = static_cast<int>(network_.edges.size());
  const std::vector<int> part_of = network_.Parts();
  const int parts = *std::max_element(part_of.begin(), part_of.end()) + 1;
  const VectorXd root_inertia = network_.Inertias().cwiseSqrt();

  std::vector<double> frequencies, rigid_mass;
  MatrixXd shapes = MatrixXd::Zero(nodes, nodes), strains = MatrixXd::Zero(edges, nodes);
  rigid_of_node_.assign(nodes, -1);
  for (int part = 0; part < parts; ++part) {
    std::vector<int> members, springs;
    std::vector<int> place(nodes, -1);
    for (int i = 0; i < nodes; ++i) {
      if (part_of[i] != part) continue;
      place[i] = static_cast<int>(members.size());
      members.push_back(i);
    }
    bool free = true;
    for (int e = 0; e < edges; ++e) {
      const Edge& edge = network_.edges[e];
      if (edge.stiffness <= 0.0 || part_of[edge.from] != part) continue;
      springs.push_back(e);
      free = free && edge.to != kGround;
    }
    const int size = static_cast<int>(members.size());
    VectorXd rigid(size);
    for (int i = 0; i < size; ++i) rigid[i] = root_inertia[members[i]];
    const double mass = rigid.squaredNorm();
    rigid /= std::sqrt(mass);
    if (free) {
      for (int node : members) rigid_of_node_[node] = static_cast<int>(rigid_mass.size());
      rigid_mass.push_back(mass);
    }
    int modes = free ? size - 1 : size;
    if (modes == 0) continue;

    MatrixXd strain_of_node = MatrixXd::Zero(springs.size(), size);
    for (std::size_t s = 0; s < springs.size(); ++s) {
      const Edge& edge = network_.edges[springs[s]];
      const double root_stiffness = std::sqrt(edge.stiffness);
      strain_of_node(s, place[edge.from]) = root_stiffness / root_inertia[edge.from];
      if (edge.to != kGround) strain_of_node(s, place[edge.to]) = -root_stiffness / root_inertia[edge.to];
    }
    MatrixXd slow;
    if (kept.modes > 0 && size >= kManyNodes) {
      const VectorXd root = root_inertia(members);
      const MatrixXd forces = root.cwiseInverse().asDiagonal() * torque_weights_(members, Eigen::all);
      const MatrixXd held = root.asDiagonal() * kept.shapes(members, Eigen::all);
      slow = LowModes(strain_of_node, free ? rigid : VectorXd(), forces, held, kept.modes);
    }
    std::shared_ptr<const dense::Svd> svd;
    if (slow.cols() > 0) {
      dense::Svd within = dense::DividedSvd(strain_of_node * slow);
      within.V = slow * within.V;
      modes = static_cast<int>(slow.cols());
      svd = std::make_shared<const dense::Svd>(std::move(within));
    } else {
      svd = Decomposed(strain_of_node);
    }
    for (int mode = modes - 1; mode >= 0; --mode) {  // singular values fall
      const int column = static_cast<int>(frequencies.size());
      frequencies.push_back(svd->values[mode]);
      VectorXd shape = svd->V.col(mode);
      if (free) shape -= rigid * rigid.dot(shape);  // exactly without momentum, not to round-off only
      for (int i = 0; i < size; ++i) shapes(members[i], column) = shape[i] / root_inertia[members[i]];
      for (std::size_t s = 0; s < springs.size(); ++s) strains(springs[s], column) = svd->U(s, mode);
    }
  }

  const int modes = static_cast<int>(frequencies.size());
  std::vector<int> order(modes);
  std::iota(order.begin(), order.end(), 0);
  std::stable_sort(order.begin(), order.end(), [&](int a, int b) { return frequencies[a] < frequencies[b]; });
  frequencies_.resize(modes);
  shapes_.resize(nodes, modes);
  strains_.resize(edges, modes);
  for (int i = 0; i < modes; ++i) {
    frequencies_[i] = frequencies[order[i]];
    shapes_.col(i) = shapes.col(order[i]);
    strains_.col(i) = strains.col(order[i]);
  }
  rigid_mass_ = Eigen::Map<const VectorXd>(rigid_mass.data(), static_cast<int>(rigid_mass.size()));
}

OutputRow EnergyCoordinates::Twist(int from, int to) const {
  OutputRow row{RowVectorXd::Zero(states()), RowVectorXd::Zero(integrators())};
  const auto add = [&](int node, double sign) {
    if (node == kGround) return;
    row.c.head(elastic_modes()) += sign * shapes_.row(node).cwiseQuotient(frequencies_.transpose());
    const int rigid = rigid_of_node_[node];
    if (rigid < 0) return;
    row.e[0] += sign;
    if (rigid > 0) row.e[rigid] += sign;
  };
  add(from, 1.0);
  add(to, -1.0);
  return row;
}

OutputRow EnergyCoordinates::TwistRate(int from, int to) const {
  OutputRow row{RowVectorXd::Zero(states()), RowVectorXd::Zero(integrators())};
  const auto add = [&](int node, double sign) {
    if (node == kGround) return;
    row.c.segment(elastic_modes(), elastic_modes()) += sign * shapes_.row(node);
    const int rigid = rigid_of_node_[node];
    if (rigid >= 0) row.c[2 * elastic_modes() + rigid] += sign / std::sqrt(rigid_mass_[rigid]);
  };
  add(from, 1.0);
  add(to, -1.0);
  return row;
}

OutputRow EnergyCoordinates::EdgeTwist(int index) const {
  const Edge& edge = network_.edges[index];
  if (edge.stiffness <= 0.0) return Twist(edge.from, edge.to);
  OutputRow row{RowVectorXd::Zero(states()), RowVectorXd::Zero(integrators())};
  row.c.head(elastic_modes()) = strains_.row(index) / std::sqrt(edge.stiffness);
  return row;
}

OutputRow EnergyCoordinates::EdgeTwistRate(int index) const {
  const Edge& edge = network_.edges[index];
  if (edge.stiffness <= 0.0) return TwistRate(edge.from, edge.to);
  OutputRow row{RowVectorXd::Zero(states()), RowVectorXd::Zero(integrators())};
  row.c.segment(elastic_modes(), elastic_modes()) =
      strains_.row(index).cwiseProduct(frequencies_.transpose()) / std::sqrt(edge.stiffness);
  return row;
}

OutputRow EnergyCoordinates::EdgeTorque(int index) const {
  const Edge& edge = network_.edges[index];
  OutputRow row = EdgeTwist(index);
  const OutputRow rate = EdgeTwistRate(index);
  row.c = edge.stiffness * row.c + edge.damping * rate.c;
  row.e *= edge.stiffness;
  return row;
}

LinearSystem EnergyCoordinates::System(const std::vector<OutputRow>& rows) const {
  const int elastic = elastic_modes(), rigid = rigid_modes(), moving = elastic + rigid;
  const int inputs = static_cast<int>(torque_weights_.cols()), edges = static_cast<int>(network_.edges.size());
  LinearSystem system;
  system.A = MatrixXd::Zero(states(), states());
  system.A.block(0, elastic, elastic, elastic) = frequencies_.asDiagonal();
  system.A.block(elastic, 0, elastic, elastic) = -MatrixXd(frequencies_.asDiagonal());
  MatrixXd rates(edges, moving);  // twist rates per (q', w_rigid)
  VectorXd damping(edges);
  for (int e = 0; e < edges; ++e) {
    rates.row(e) = EdgeTwistRate(e).c.tail(moving);
    damping[e] = network_.edges[e].damping;
  }
  const MatrixXd dissipation = rates.transpose() * damping.asDiagonal() * rates;
  // Symmetric to the last bit: what decomposes A relies on it (block_newton.h).
  system.A.bottomRightCorner(moving, moving) = -0.5 * (dissipation + dissipation.transpose());

  system.B = MatrixXd::Zero(states(), inputs);
  system.B.middleRows(elastic, elastic) = shapes_.transpose() * torque_weights_;
  system.P = MatrixXd::Zero(rigid, states());
  for (int r = 0; r < rigid; ++r) {
    for (int i = 0; i < network_.size(); ++i) {
      if (rigid_of_node_[i] == r) system.B.row(2 * elastic + r) += torque_weights_.row(i);
    }
    system.B.row(2 * elastic + r) /= std::sqrt(rigid_mass_[r]);
    system.P(r, 2 * elastic + r) = 1.0 / std::sqrt(rigid_mass_[r]);
    if (r > 0) system.P(r, 2 * elastic) = -1.0 / std::sqrt(rigid_mass_[0]);
  }

  const int outputs = static_cast<int>(rows.size());
  system.C.resize(outputs, states());
  system.E.resize(outputs, rigid);
  system.D = MatrixXd::Zero(outputs, inputs);
  for (int i = 0; i < outputs; ++i) {
    assert(rows[i].c.size() == states() && rows[i].e.size() == rigid);
    system.C.row(i) = rows[i].c;
    system.E.row(i) = rows[i].e;
  }
  return system;
}

void EnergyCoordinates::FromPhysical(const MatrixXd& angles, const MatrixXd& speeds, MatrixXd& x, MatrixXd& p) const {
  assert(angles.rows() == network_.size() && speeds.rows() == network_.size() && angles.cols() == speeds.cols());
  const int elastic = elastic_modes(), rigid = rigid_modes();
  const VectorXd inertias = network_.Inertias();
  MatrixXd mean_angle = MatrixXd::Zero(rigid, angles.cols()), mean_speed = mean_angle;
  for (int i = 0; i < network_.size(); ++i) {
    const int r = rigid_of_node_[i];
    if (r < 0) continue;
    mean_angle.row(r) += inertias[i] / rigid_mass_[r] * angles.row(i);
    mean_speed.row(r) += inertias[i] / rigid_mass_[r] * speeds.row(i);
  }
  MatrixXd twists = angles;  // the mean is taken off first: it may be large
  for (int i = 0; i < network_.size(); ++i) {
    if (rigid_of_node_[i] >= 0) twists.row(i) -= mean_angle.row(rigid_of_node_[i]);
  }
  const MatrixXd momentum_of_mode = shapes_.transpose() * inertias.asDiagonal();
  x.resize(states(), angles.cols());
  x.topRows(elastic) = frequencies_.asDiagonal() * Multiply(momentum_of_mode, twists);
  x.middleRows(elastic, elastic) = Multiply(momentum_of_mode, speeds);
  x.bottomRows(rigid) = rigid_mass_.cwiseSqrt().asDiagonal() * mean_speed;
  p = mean_angle;
  for (int r = 1; r < rigid; ++r) p.row(r) -= mean_angle.row(0);
}

void EnergyCoordinates::ToPhysical(const MatrixXd& x, const MatrixXd& p, MatrixXd& angles, MatrixXd& speeds) const {
  assert(x.rows() == states() && p.rows() == integrators() && x.cols() == p.cols());
  const int elastic = elastic_modes();
  angles = Multiply(shapes_ * frequencies_.cwiseInverse().asDiagonal(), x.topRows(elastic));
  speeds = Multiply(shapes_, x.middleRows(elastic, elastic));
  for (int i = 0; i < network_.size(); ++i) {
    const int r = rigid_of_node_[i];
    if (r < 0) continue;
    angles.row(i) += p.row(0);
    if (r > 0) angles.row(i) += p.row(r);
    speeds.row(i) += x.row(2 * elastic + r) / std::sqrt(rigid_mass_[r]);
  }
}

}  // namespace dynoproof::mechanics
