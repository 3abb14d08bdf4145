// What the realtime solver can propagate exactly: the linear part of a component, with its nonlinear laws taken out as
// channels through which a torque enters.
#pragma once

#include <Eigen/Dense>
#include <vector>

#include "linear/linear_system.h"
#include "model/law.h"

namespace dynoproof {

/// One nonlinear law. It sees twist and rate, and answers with the torque beyond its linear spring and damper.
struct LawChannel {
  const Law* law = nullptr;
  int state_offset = 0;   // the law's own states within the component's states
  int mode_offset = 0;    // its modes within the component's modes
  double mobility = 0.0;  // 1/I_from + 1/I_to: the relative acceleration per unit of transmitted torque
  SpringDamper linear;    // what of its torque is in `system` already
};

/// `system` has as inputs the component's inputs followed by one torque per channel, and as outputs the component's
/// outputs followed by [twist, rate] per channel. A channel torque acts on the rate through B like on any node.
struct LinearPart {
  mechanics::LinearSystem system;
  std::vector<LawChannel> channels;
  /// The component's linear states s (its first states, before those of the laws) from and to the coordinates (x, p)
  /// of `system`: x = x_from_state s, p = p_from_state s, s = state_from_x x + state_from_p p.
  Eigen::MatrixXd x_from_state, p_from_state, state_from_x, state_from_p;
};

}  // namespace dynoproof
