// Torque of an induction machine, oriented to its rotor flux: flux model, flux and current controllers, decoupling,
// voltage limit, one period of computing time. What it does and how it is tuned: README.md of the plugin
// rotor_flux_control, which runs exactly this code.
#pragma once

#include "control10k/machine.h"

namespace control10k {

struct TorqueConfig {
  MachineModel machine;
  double period_s = 1e-4;
  double current_bandwidth_Hz = 300.0, flux_bandwidth_Hz = 5.0;
  double dc_link_V = 565.0;
  double overload = 2.0;           // largest over rated current
  double initial_torque_Nm = 0.0;  // of the machine when the control starts
};

/// False where a number is missing or out of its range.
bool IsUsable(const TorqueConfig& config);

struct TorqueInputs {
  double torque_set_Nm, i_alpha_A, i_beta_A, speed_rad_per_s;
};

struct TorqueState {
  double begun = 0.0;                                                    // 0 before the first step
  double frame_alpha = 1.0, frame_beta = 0.0;                            // unit vector along the rotor flux
  double flux_Vs = 0.0;                                                  // magnitude of the rotor flux
  double integral_d_V = 0.0, integral_q_V = 0.0, integral_flux_A = 0.0;  // of the three controllers
  double next_alpha_V = 0.0, next_beta_V = 0.0;                          // computed last, given next
};

struct TorqueOutputs {
  double u_alpha_V, u_beta_V;  // mean voltage of the coming period; computed in the step before
  double torque_Nm;            // estimated
  double i_q_set_A;
};

class TorqueControl {
 public:
  /// The config must be usable (IsUsable).
  explicit TorqueControl(const TorqueConfig& config);
  /// One period.
  TorqueOutputs Step(TorqueState& state, const TorqueInputs& in) const;

 private:
  void Begin(TorqueState& state, double speed_rad_per_s) const;

  MachineModel m_;
  double period_s_, voltage_limit_, current_limit_, gain_, inverse_gain_, reset_, flux_gain_, flux_reset_,
      initial_torque_;
  double rotor_rate_, ampere_per_torque_flux_;
  double flux_decay_;  // of the flux over a period
};

}  // namespace control10k
