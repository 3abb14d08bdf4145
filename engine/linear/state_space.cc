#include "linear/state_space.h"

#include <vector>

namespace dynoproof::mechanics {
namespace {

using Eigen::MatrixXd;
using Eigen::RowVectorXd;
using Eigen::VectorXd;

/// Takes out the states number `first` and up that nothing, not even another state, sees; returns how many.
int DropUnseen(EnergyStateSpace& system, Eigen::Index first) {
  int dropped = 0;
  for (Eigen::Index i = system.h.size(); i-- > first;) {
    if (system.h[i] != 0.0 || !system.a.col(i).isZero(0.0)) continue;
    std::vector<Eigen::Index> kept;
    for (Eigen::Index j = 0; j < system.h.size(); ++j) {
      if (j != i) kept.push_back(j);
    }
    system = {MatrixXd(system.a(kept, kept)), VectorXd(system.b(kept)), RowVectorXd(system.h(kept)), 0};
    ++dropped;
  }
  return dropped;
}

}  // namespace

EnergyStateSpace AssembleStateSpace(const Network& network, const VectorXd& input, const Output& output,
                                    const ModalAnalysis& modal) {
  const Eigen::Index r = modal.rigid, e = modal.omega.size() - r;
  EnergyStateSpace system{EnergyStateMatrix(modal, ModalDamping(network, modal.phi)), VectorXd::Zero(2 * e + r),
                          RowVectorXd::Zero(2 * e + r), 0};
  const VectorXd force = modal.phi.transpose() * input;
  system.b.segment(e, e) = force.tail(e);
  system.b.tail(r) = force.head(r);
  const auto position = [&](const RowVectorXd& row, double factor) {
    system.h.head(e) = factor * row.tail(e).cwiseQuotient(modal.omega.tail(e).transpose());
  };
  const auto rate = [&](const RowVectorXd& row, double factor) {
    system.h.segment(e, e) = factor * row.tail(e);
    system.h.tail(r) = factor * row.head(r);
  };
  if (output.kind == OutputKind::kEdgeTorque) {
    const Edge& edge = network.edges[output.index];
    RowVectorXd twist = modal.phi.row(edge.from);
    if (edge.to != kGround) twist -= modal.phi.row(edge.to);
    position(twist, edge.stiffness);
    rate(twist, edge.damping);
  } else if (output.kind == OutputKind::kSpeed || modal.rigid > 0) {
    rate(modal.phi.row(output.index), 1.0);
  } else {
    position(modal.phi.row(output.index), 1.0);
  }
  system.left_out = DropUnseen(system, 2 * e);
  return system;
}

}  // namespace dynoproof::mechanics
