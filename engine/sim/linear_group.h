// All linear parts of a rig joined to one linear system: drive lines with the lags before and behind them. What it
// reads from outside and what it answers are slots of the rig's signal table.
#pragma once

#include <vector>

#include "linear/linear_system.h"
#include "model/linear_part.h"
#include "sim/rig.h"

namespace dynoproof {

/// Which block the realtime solver carries how.
struct Roles {
  std::vector<int> held;       // stateless, fed by held signals only: evaluated when an interval begins
  std::vector<int> linear;     // carried exactly
  std::vector<int> nonlinear;  // carried by Runge-Kutta substeps; stateless ones that feed dynamics count too
  std::vector<int> behind;     // stateless, feed no dynamics: evaluated when somebody looks
};
Roles AssignRoles(const Rig& rig);

struct LinearGroup {
  /// Inputs: the slots of `reads`, then one torque per channel. Outputs: the slots of `writes`, then twist and rate of
  /// each channel.
  mechanics::LinearSystem system;
  std::vector<int> reads, writes;
  std::vector<bool> read_is_held;  // by `reads`: constant over an interval
  struct JoinedChannel {
    LawChannel channel;
    int state, mode;    // in the frame
    int states, modes;  // how many
    bool switches;      // has modes and does not stick
  };
  std::vector<JoinedChannel> channels;
  /// x and p for the states of a frame; and back, leaving the states of other blocks as they are.
  void FromStates(const std::vector<double>& states, Eigen::VectorXd& x, Eigen::VectorXd& p) const;
  void ToStates(const Eigen::VectorXd& x, const Eigen::VectorXd& p, std::vector<double>& states) const;

  struct Member {
    int first_state;       // in the frame
    int first_x, first_p;  // first_p < 0: its integrators became states, behind its own
    Eigen::MatrixXd x_from_state, p_from_state, state_from_x, state_from_p;
  };
  std::vector<Member> members;
};

LinearGroup JoinLinearParts(const Rig& rig, const Roles& roles);

}  // namespace dynoproof
