// PI speed control with torque feedthrough, (2.3) of the thesis:
//
//   T_ref = k_P (omega_ref - omega) + k_I integral(omega_ref - omega) - k_V T_shaft,   |T_ref| <= T_limit
//
// T_shaft = k (phi_rotor - phi_device): positive when the rotor drives the device. The feedthrough enters with a minus:
// the machine amplifies the torque that the device puts on the rotor, -T_shaft, so that the rotor feels like an inertia
// I_1 / (1 + k_V). (2.3) prints a plus; with it the loop is stable at every gain of chapter 5 and there would be
// nothing to suppress.
#pragma once

namespace control10k {

struct SpeedConfig {
  double k_P_Nms_per_rad = 0.0, k_I_Nm_per_rad = 0.0;
  double T_limit_Nm = 1e9;
};

struct SpeedState {
  double integral_Nm = 0.0;
};

/// One period; T_shaft as the feedthrough is to see it. The integrator rests while it would push further into the
/// limit.
inline double SpeedStep(const SpeedConfig& config, SpeedState& state, double period_s, double omega_ref_rad_per_s,
                        double omega_rad_per_s, double k_V, double T_shaft_Nm) {
  const double e = omega_ref_rad_per_s - omega_rad_per_s, limit = config.T_limit_Nm;
  const double wanted = config.k_P_Nms_per_rad * e + state.integral_Nm - k_V * T_shaft_Nm;
  if (!((wanted > limit && e > 0.0) || (wanted < -limit && e < 0.0))) {
    state.integral_Nm += config.k_I_Nm_per_rad * period_s * e;
  }
  return wanted > limit ? limit : wanted < -limit ? -limit : wanted;
}

}  // namespace control10k
