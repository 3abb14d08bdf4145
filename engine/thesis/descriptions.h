// The five ways to write down one and the same chain of inertias (thesis Sec. 2.2.1) and the transformations between
// them (Sec. 2.2.3). All for a chain of m inertias; the thesis writes them for two.
#pragma once

#include <Eigen/Dense>

#include "base/status.h"
#include "linear/network.h"

namespace dynoproof::mechanics {

/// I_1 --(k_1, c_1)-- I_2 -- ... -- I_m, free at both ends.
struct Chain {
  Eigen::VectorXd inertia;    // m [kg m^2], > 0
  Eigen::VectorXd stiffness;  // m - 1 [N m/rad], > 0
  Eigen::VectorXd damping;    // m - 1 [N m s/rad], >= 0

  int size() const { return static_cast<int>(inertia.size()); }
};

/// The chain that a network is: m >= 2 nodes and m - 1 edges, edge i joining node i (`from`) to node i + 1 (`to`) by a
/// spring. Fails (exit code 2) where it is not, naming the edge.
Result<Chain> ChainOf(const Network& network);
Network NetworkOf(const Chain& chain);

/// x' = A x + b T_airgap, T_shaft = c x.
struct FirstOrder {
  Eigen::MatrixXd A;
  Eigen::VectorXd b;
  Eigen::RowVectorXd c;
};

/// x'' = K x + C x' + b T_airgap, T_shaft = position x + rate x'. K and C carry the signs of the thesis (negative
/// semi-definite up to scaling).
struct SecondOrder {
  Eigen::MatrixXd K, C;
  Eigen::VectorXd b;
  Eigen::RowVectorXd position, rate;
};

/// Where the torque enters and which shaft is read: T_airgap acts on node `input` (0-based), T_shaft is that of shaft
/// `shaft` between nodes `shaft` and `shaft` + 1. Both must exist.
struct ChainPorts {
  int input;
  int shaft;
};

/// (2.8) x_a = [phi_1, w_1, phi_2, w_2, ...], order 2 m.
FirstOrder Absolute(const Chain& chain, ChainPorts ports);
/// (2.9) x_d = [phi_1 - phi_2, w_1 - w_2, phi_2 - phi_3, ...], order 2 m - 2.
FirstOrder Differential(const Chain& chain, ChainPorts ports);
/// (2.10) x_m = [phi_1 - phi_2, w_1, phi_2 - phi_3, w_2, ..., w_m], order 2 m - 1: with two masses
/// [phi_1 - phi_2, w_1, w_2] and b = [0, 1/I_1, 0] (the print has [0, 0, 1/I_1]).
FirstOrder Mixed(const Chain& chain, ChainPorts ports);
/// (2.11) x_phi = [phi_1, ..., phi_m], order m, twice differentiated.
SecondOrder Angles(const Chain& chain, ChainPorts ports);
/// (2.12), (2.36) x_Delta = [phi_1 - phi_2, ...], order m - 1, twice differentiated. C_Delta = -c (1/I_1 + 1/I_2) with
/// its minus, which the print of (2.12) lacks and (2.32) needs.
SecondOrder Twists(const Chain& chain, ChainPorts ports);

/// T of (2.19), 2 m x 2 m: T x_a = [phi_1, w_1, x_d] (2.20).
Eigen::MatrixXd AbsoluteToDifferential(int m);
/// 2 m - 1 square: x_m -> [w_1, x_d], which shows (2.24) as (2.21) shows (2.23).
Eigen::MatrixXd MixedToDifferential(int m);
/// P of (2.26), 2 m x 2 m: P x_a = [phi_1, ..., phi_m, w_1, ..., w_m] (2.25). P^-1 = P^T; P is its own inverse for
/// m = 2 (and 1) only, against the print.
Eigen::MatrixXd SortAnglesFirst(int m);
/// [0 I; K C] of (2.27) and (2.32).
Eigen::MatrixXd Companion(const SecondOrder& description);

}  // namespace dynoproof::mechanics
