#include "linear/modes.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

#include "linear/check.h"
#include "linear/damped_eigenvalues.h"
#include "linear/symmetric_eigen.h"

namespace dynoproof::mechanics {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

/// The nodes of one connected part and whether a spring holds it to the ground.
struct Part {
  std::vector<int> nodes;
  bool held = false;
};

std::vector<Part> PartsOf(const Network& network) {
  const std::vector<int> number = network.Parts();
  std::vector<Part> parts(static_cast<std::size_t>(*std::max_element(number.begin(), number.end()) + 1));
  for (int i = 0; i < network.size(); ++i) parts[number[i]].nodes.push_back(i);
  for (const Edge& edge : network.edges) {
    if (edge.to == kGround && edge.stiffness > 0.0) parts[number[edge.from]].held = true;
  }
  return parts;
}

/// M^-1/2 K M^-1/2 of one part.
MatrixXd MassNormalised(const Network& network, const Part& part) {
  std::vector<int> local(static_cast<std::size_t>(network.size()), -1);
  for (std::size_t i = 0; i < part.nodes.size(); ++i) local[part.nodes[i]] = static_cast<int>(i);
  const int n = static_cast<int>(part.nodes.size());
  MatrixXd matrix = MatrixXd::Zero(n, n);
  for (const Edge& edge : network.edges) {
    const int a = local[edge.from], b = edge.to == kGround ? -1 : local[edge.to];
    if (a < 0 || edge.stiffness <= 0.0) continue;
    matrix(a, a) += edge.stiffness / network.nodes[edge.from].inertia;
    if (b < 0) continue;
    matrix(b, b) += edge.stiffness / network.nodes[edge.to].inertia;
    const double both = std::sqrt(network.nodes[edge.from].inertia) * std::sqrt(network.nodes[edge.to].inertia);
    matrix(a, b) -= edge.stiffness / both;
    matrix(b, a) -= edge.stiffness / both;
  }
  return matrix;
}

double Twist(const Edge& edge, const Eigen::Ref<const VectorXd>& angles) {
  return angles[edge.from] - (edge.to == kGround ? 0.0 : angles[edge.to]);
}

/// omega^2 of a mass-normalised shape as its strain energy. The error is of second order in that of the shape.
double RayleighQuotient(const Network& network, const VectorXd& inertias, const Eigen::Ref<const VectorXd>& shape) {
  double strain = 0.0;
  for (const Edge& edge : network.edges) strain += edge.stiffness * std::pow(Twist(edge, shape), 2);
  return strain / shape.cwiseAbs2().dot(inertias);
}

Mode Describe(const Network& network, const VectorXd& inertias, const Eigen::Ref<const VectorXd>& shape, double omega) {
  Mode mode{omega / (2.0 * std::numbers::pi), 0.0, {}, shape, {}, VectorXd::Zero(std::ssize(network.edges))};
  Eigen::Index largest = 0;
  mode.shape.cwiseAbs().maxCoeff(&largest);
  mode.shape /= shape[largest];
  mode.kinetic = (omega > 0.0 ? 0.5 : 1.0) * inertias.cwiseProduct(shape.cwiseAbs2());
  if (omega > 0.0) {
    for (Eigen::Index e = 0; e < mode.strain.size(); ++e) {
      const Edge& edge = network.edges[static_cast<std::size_t>(e)];
      mode.strain[e] = 0.5 * edge.stiffness * std::pow(Twist(edge, shape) / omega, 2);
    }
  }
  return mode;
}

double DampingRatio(const std::pair<std::complex<double>, std::complex<double>>& pair) {
  if (pair.first.imag() != 0.0) return -pair.first.real() / std::abs(pair.first);
  const double a = -pair.first.real(), b = -pair.second.real();
  return (a + b) / (2.0 * std::sqrt(a * b));
}

}  // namespace

std::vector<std::complex<double>> ModalAnalysis::DampedEigenvalues() const {
  std::vector<std::complex<double>> all;
  for (const Mode& mode : modes) {
    all.push_back(mode.damped.first);
    all.push_back(mode.damped.second);
  }
  return all;
}

Result<ModalAnalysis> Modes(const Network& network) {
  if (Status status = CheckNetwork(network)) return *status;
  const int n = network.size();
  const VectorXd inertias = network.Inertias();
  MatrixXd shapes = MatrixXd::Zero(n, n);
  VectorXd omega(n);
  ModalAnalysis result;
  int column = 0;
  for (const Part& part : PartsOf(network)) {
    const SymmetricEigen eigen = SolveSymmetric(MassNormalised(network, part));
    const int size = static_cast<int>(part.nodes.size());
    double part_inertia = 0.0;
    for (const int node : part.nodes) part_inertia += inertias[node];
    for (int m = 0; m < size; ++m, ++column) {
      const bool is_rigid = m == 0 && !part.held;
      for (int i = 0; i < size; ++i) {
        const int node = part.nodes[i];
        shapes(node, column) =
            is_rigid ? 1.0 / std::sqrt(part_inertia) : eigen.vectors(i, m) / std::sqrt(inertias[node]);
      }
      omega[column] = is_rigid ? 0.0 : std::sqrt(RayleighQuotient(network, inertias, shapes.col(column)));
      if (!std::isfinite(omega[column])) return Failure{"a mode has no finite frequency", network.nodes[0].name, {}, 3};
      if (is_rigid) ++result.rigid;
    }
  }
  std::vector<int> order(static_cast<std::size_t>(n));
  std::iota(order.begin(), order.end(), 0);
  std::stable_sort(order.begin(), order.end(), [&](int a, int b) { return omega[a] < omega[b]; });
  result.omega.resize(n);
  result.phi.resize(n, n);
  for (int m = 0; m < n; ++m) {
    result.omega[m] = omega[order[m]];
    result.phi.col(m) = shapes.col(order[m]);
    result.modes.push_back(Describe(network, inertias, result.phi.col(m), result.omega[m]));
  }
  Result<std::vector<EigenvaluePair>> damped = DampedPairs(network, result);
  if (!damped.ok()) return damped.failure();
  for (int m = 0; m < n; ++m) {
    result.modes[m].damped = (*damped)[m];
    result.modes[m].damping_ratio = m < result.rigid ? 0.0 : DampingRatio((*damped)[m]);
  }
  return result;
}

Result<VectorXd> UndampedFrequencies(const Network& network) {
  if (Status status = CheckNetwork(network)) return *status;
  std::vector<double> all;
  for (const Part& part : PartsOf(network)) {
    const VectorXd values = SymmetricValues(MassNormalised(network, part));
    for (Eigen::Index m = 0; m < values.size(); ++m) {
      const bool is_rigid = m == 0 && !part.held;
      all.push_back(is_rigid ? 0.0 : std::sqrt(values[m]) / (2.0 * std::numbers::pi));
    }
  }
  std::sort(all.begin(), all.end());
  return VectorXd(Eigen::Map<const VectorXd>(all.data(), std::ssize(all)));
}

MatrixXd ModalDamping(const Network& network, const MatrixXd& phi) {
  MatrixXd rates(std::ssize(network.edges), phi.cols());
  for (Eigen::Index e = 0; e < rates.rows(); ++e) {
    const Edge& edge = network.edges[static_cast<std::size_t>(e)];
    rates.row(e) = phi.row(edge.from);
    if (edge.to != kGround) rates.row(e) -= phi.row(edge.to);
    rates.row(e) *= std::sqrt(edge.damping);
  }
  return rates.transpose() * rates;
}

MatrixXd EnergyStateMatrix(const ModalAnalysis& modal, const MatrixXd& modal_damping) {
  const Eigen::Index r = modal.rigid, e = modal.omega.size() - r;
  MatrixXd a = MatrixXd::Zero(2 * e + r, 2 * e + r);
  a.block(0, e, e, e).diagonal() = modal.omega.tail(e);
  a.block(e, 0, e, e).diagonal() = -modal.omega.tail(e);
  a.block(e, e, e, e) = -modal_damping.bottomRightCorner(e, e);
  a.block(e, 2 * e, e, r) = -modal_damping.bottomLeftCorner(e, r);
  a.block(2 * e, e, r, e) = -modal_damping.topRightCorner(r, e);
  a.block(2 * e, 2 * e, r, r) = -modal_damping.topLeftCorner(r, r);
  return a;
}

}  // namespace dynoproof::mechanics
