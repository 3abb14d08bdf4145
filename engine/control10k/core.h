// The 10 kHz core of the test bed's control (C in Fig. 2.2 of the thesis): PI speed control with torque feedthrough
// (2.3), the shaft torque filtered by adaptive notches (Fig. 5.9). The machine's currents are torque_control.h's, which
// takes T_ref as its set point.
// A step needs no heap, lock, exception, system call or other library than the C mathematical functions; its memory is
// CoreState, only doubles. Core is const after its construction and may be shared.
#pragma once

#include "control10k/speed_control.h"
#include "control10k/suppression.h"

namespace control10k {

struct CoreConfig {
  SpeedConfig speed;
  SuppressionConfig suppression;
};

bool IsUsable(const CoreConfig& config);

struct CoreInputs {
  double omega_ref_rad_per_s, omega_rad_per_s, T_shaft_Nm;
  double k_V;  // feedthrough gain, may change while running
  bool adapt;  // adaptation on
};

struct CoreState {
  SpeedState speed;
  double T_filtered_Nm = 0.0, T_ref_Nm = 0.0;  // of the last step
  SuppressionState suppression;
};

class Core {
 public:
  /// The config must be usable (IsUsable).
  explicit Core(const CoreConfig& config) : config_(config), suppression_(config.suppression) {}

  void Start(CoreState& state) const {
    state = {};
    suppression_.Start(state.suppression);
  }
  /// One period; returns T_ref.
  double Step(CoreState& state, const CoreInputs& in) const;

  const CoreConfig& config() const { return config_; }
  const Suppression& suppression() const { return suppression_; }

 private:
  CoreConfig config_;
  Suppression suppression_;
};

}  // namespace control10k
