// The torque-feedthrough loop of chapter 5 around a drive line: the measured shaft torque, amplified, is the reference
// of the airgap torque, through a first-order actuator, sampled and held. The sign of the feedthrough decides whether
// the loop can become unstable at all.
#pragma once

#include <Eigen/Dense>
#include <complex>
#include <vector>

#include "base/status.h"
#include "linear/network.h"

namespace dynoproof::mechanics {

/// T_ref(t_k) = feedthrough * T_shaft(t_(k - delay_samples)), held over a period; T_airgap follows with tau_a.
struct TorqueLoop {
  double feedthrough;     // [-]; +k_V is the sign of (2.3), (2.5), -k_V that of chapter 5
  double tau_a;           // [s], > 0
  double period_s;        // [s], > 0
  int delay_samples = 0;  // >= 0
};

/// One mode of the sampled loop, from the eigenvalue z of a period: s = log(z) / period.
struct LoopMode {
  double frequency_hz;  // Im s / (2 pi), 0 ... half the sampling rate
  double growth_per_s;  // Re s: positive where the oscillation grows
  std::complex<double> z;
};

/// All modes of the loop (of a conjugate pair the upper), the fastest growing first. `input`: weights of the airgap
/// torque over the nodes; `shaft`: edge whose torque is fed back. Discretised exactly by the matrix exponential.
/// z = 0 (the delay line's own) is left out. Fails (exit code 2) on wrong input, (3) where an eigenvalue problem fails.
Result<std::vector<LoopMode>> TorqueLoopModes(const Network& network, const Eigen::VectorXd& input, int shaft,
                                              const TorqueLoop& loop);

}  // namespace dynoproof::mechanics
