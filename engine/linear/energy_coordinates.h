// A network in coordinates whose squares are energies: the well-conditioned way from inertias, springs and dampers to a
// state-space model, with the rigid-body angles kept apart as integrators.
//
// With the mass-normalised undamped modes q and their frequencies W (per connected part, Network::Parts) the state is
//   x = (W q_elastic, q_elastic', w_rigid),   x1' = W x2,  x2' = -W x1 - Cq x2 - .. + forces,
// so that A is skew-symmetric plus negative semi-definite and |x|^2 / 2 is the stored energy. w_rigid is the mean speed
// of a part that no spring holds to the ground, times the root of its inertia. What no force can do is exactly zero:
// rigid speeds of a part free of ground and of damping-only links see no damping, twists inside a part no rigid angle.
// The integrators p are angles: the mean (momentum-weighted) angle of the first free part, then for each further free
// part its mean angle minus that of the first: the twist of a gap is not the difference of two large angles.
#pragma once

#include <Eigen/Dense>
#include <vector>

#include "base/status.h"
#include "linear/linear_system.h"
#include "linear/network.h"

namespace dynoproof::mechanics {

/// One output y = c x + e p of a system in energy coordinates.
struct OutputRow {
  Eigen::RowVectorXd c;  // n
  Eigen::RowVectorXd e;  // q
};

/// How much of each large part of a network is kept: its lowest modes, and what the inputs do at rest to the others (low_modes.h).
struct Kept {
  int modes = 0;           // of a part, the others taken together among them; 0: all
  Eigen::MatrixXd shapes;  // nodes x any: angles or speeds that stay as they are, as those of a start
};

class EnergyCoordinates {
 public:
  /// `torque_weights` (nodes x m): how much of each input acts on each node [-], torques in N m. Fails (exit code 2) on
  /// inertias that are not positive, negative or non-finite springs and dampers, and edges that join a node to itself.
  static Result<EnergyCoordinates> Build(const Network& network, const Eigen::MatrixXd& torque_weights,
                                         const Kept& kept = {});

  int elastic_modes() const { return static_cast<int>(frequencies_.size()); }
  int rigid_modes() const { return static_cast<int>(rigid_mass_.size()); }
  int states() const { return 2 * elastic_modes() + rigid_modes(); }
  int integrators() const { return rigid_modes(); }
  /// Undamped frequencies W of the elastic modes, rising [rad/s].
  const Eigen::VectorXd& frequencies() const { return frequencies_; }

  /// Output rows. Node: angle [rad], speed [rad/s]. Edge: twist phi_from - phi_to, its rate, and the torque
  /// k twist + c rate [N m] (the ground stands still at angle 0). Twist, TwistRate: between any two nodes (or kGround).
  OutputRow Angle(int node) const { return Twist(node, kGround); }
  OutputRow Speed(int node) const { return TwistRate(node, kGround); }
  OutputRow Twist(int from, int to) const;
  OutputRow TwistRate(int from, int to) const;
  OutputRow EdgeTwist(int edge) const;
  OutputRow EdgeTwistRate(int edge) const;
  OutputRow EdgeTorque(int edge) const;

  /// A, B, P of the network and C, E of these rows; D = 0.
  LinearSystem System(const std::vector<OutputRow>& rows) const;

  /// Node angles [rad] and speeds [rad/s] to (x, p) and back, any number of them as columns.
  void FromPhysical(const Eigen::MatrixXd& angles, const Eigen::MatrixXd& speeds, Eigen::MatrixXd& x,
                    Eigen::MatrixXd& p) const;
  void ToPhysical(const Eigen::MatrixXd& x, const Eigen::MatrixXd& p, Eigen::MatrixXd& angles,
                  Eigen::MatrixXd& speeds) const;

 private:
  EnergyCoordinates() = default;
  void FindModes(const Kept& kept);

  Network network_;
  Eigen::MatrixXd torque_weights_;  // nodes x m
  Eigen::VectorXd frequencies_;     // W, rising; beyond what is kept, of the faster modes taken together
  Eigen::MatrixXd shapes_;          // nodes x elastic: M^-1/2 V, displacement of a node per q
  Eigen::MatrixXd strains_;         // edges x elastic: sqrt(k) twist per W q (the left singular vectors), 0 where k = 0
  std::vector<int> rigid_of_node_;  // index of the rigid mode that moves the node, -1 in a part held to the ground
  Eigen::VectorXd rigid_mass_;      // inertia of the free parts
};

}  // namespace dynoproof::mechanics
