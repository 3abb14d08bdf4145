// A network with one input and one output in state space, in energy coordinates: what zeros and loops are computed
// from.
#pragma once

#include <Eigen/Dense>

#include "linear/frequency_response.h"
#include "linear/modes.h"
#include "linear/network.h"

namespace dynoproof::mechanics {

/// x' = a x + b u, y = h x with x = (omega q, q', q'_rigid) as in EnergyStateMatrix.
struct EnergyStateSpace {
  Eigen::MatrixXd a;
  Eigen::VectorXd b;
  Eigen::RowVectorXd h;
  int left_out;  // rigid-body speeds that neither the output nor another state sees: not among the states
};

/// The state space of a network, its modes given. Angles of a network with rigid-body modes grow without bound and
/// are no output of it: their speeds take their place.
EnergyStateSpace AssembleStateSpace(const Network& network, const Eigen::VectorXd& input, const Output& output,
                                    const ModalAnalysis& modal);

}  // namespace dynoproof::mechanics
