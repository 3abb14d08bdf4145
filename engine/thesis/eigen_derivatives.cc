#include "thesis/eigen_derivatives.h"

#include "linear/dense.h"

namespace dynoproof::mechanics {

using Eigen::MatrixXd;
using Eigen::VectorXd;

VectorXd LeftScaling(const Chain& chain) { return chain.stiffness / chain.stiffness[0]; }

MatrixXd ReducedModes::Left(const Chain& chain) const { return LeftScaling(chain).asDiagonal() * right; }

MatrixXd ReducedModes::Inverse(const Chain& chain) const {
  return gamma.cwiseInverse().asDiagonal() * right.transpose() * LeftScaling(chain).asDiagonal();
}

ReducedModes SolveReduced(const Chain& chain) {
  const MatrixXd k = Twists(chain, {0, 0}).K;
  const VectorXd root = LeftScaling(chain).cwiseSqrt();
  const MatrixXd symmetric = root.asDiagonal() * k * root.cwiseInverse().asDiagonal();
  const auto [values, vectors] = dense::Symmetric(symmetric);
  // Rising lambda is falling nu: turn the order round.
  ReducedModes modes{values.reverse(), root.cwiseInverse().asDiagonal() * vectors.rowwise().reverse(), {}};
  modes.right.colwise().normalize();
  modes.gamma = (modes.right.transpose() * LeftScaling(chain).asDiagonal() * modes.right).diagonal();
  return modes;
}

VectorXd LastInertiaDerivative(const Chain& chain, const ReducedModes& modes) {
  const Eigen::Index last = chain.stiffness.size() - 1;
  const double k_n = chain.stiffness[last], inertia = chain.inertia[last + 1];
  return k_n * k_n / (chain.stiffness[0] * inertia * inertia) *
         modes.right.row(last).transpose().cwiseAbs2().cwiseQuotient(modes.gamma);
}

FrequencyDerivatives DifferentiateFrequencies(const Network& network, const ModalAnalysis& modal, double equal) {
  const Eigen::Index n = modal.omega.size();
  FrequencyDerivatives d{MatrixXd(n, n), MatrixXd(n, std::ssize(network.edges))};
  d.by_inertia = -(modal.omega.cwiseAbs2().asDiagonal() * modal.phi.transpose().cwiseAbs2());
  for (Eigen::Index e = 0; e < d.by_stiffness.cols(); ++e) {
    const Edge& edge = network.edges[static_cast<std::size_t>(e)];
    VectorXd twist = modal.phi.row(edge.from).transpose();
    if (edge.to != kGround) twist -= modal.phi.row(edge.to).transpose();
    d.by_stiffness.col(e) = twist.cwiseAbs2();
  }
  for (Eigen::Index first = 0; first < n;) {
    Eigen::Index end = first + 1;
    while (end < n && modal.omega[end] - modal.omega[end - 1] <= equal * modal.omega[end]) ++end;
    const Eigen::Index count = end - first;
    if (count > 1) {
      const Eigen::RowVectorXd inertia = d.by_inertia.middleRows(first, count).colwise().sum();
      const Eigen::RowVectorXd stiffness = d.by_stiffness.middleRows(first, count).colwise().sum();
      d.by_inertia.middleRows(first, count).setZero();
      d.by_stiffness.middleRows(first, count).setZero();
      d.by_inertia.row(first) = inertia;
      d.by_stiffness.row(end - 1) = stiffness;
    }
    first = end;
  }
  return d;
}

}  // namespace dynoproof::mechanics
