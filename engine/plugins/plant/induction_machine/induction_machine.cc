#include "plugins/plant/induction_machine/induction_machine.h"

namespace dynoproof {

PluginInfo InductionMachine::Info() {
  return {"plant",
          "induction_machine",
          "induction machine as fundamental wave model, from its rated data",
          "L_sigma di/dt = u - R_s i - dpsi/dt; dpsi/dt = R_R i - (R_R/L_M - j p w) psi; T = 1.5 p Im(psi* i)",
          "thesis Sec. 3.1 (model class), Tables C.1, 2.1, 2.7 (rated data); inverse-Gamma circuit",
          {}};
}

InductionMachine::InductionMachine(const Params& params) : initial_torque_(params.initial_torque_Nm) {
  params.Derive(m_);
  inverse_leakage_ = 1.0 / m_.L_sigma;
  rotor_rate_ = m_.rotor_rate();
  damping_ = inverse_leakage_ * (m_.R_s + m_.R_R);
  transfer_ = inverse_leakage_ * rotor_rate_;
  layout_.inputs = {{"u_alpha", "V", "phase voltage, real part", 300.0},
                    {"u_beta", "V", "phase voltage, imaginary part", 300.0},
                    {"speed", "rad/s", "speed of the shaft", params.rated_speed_rad_per_s}};
  layout_.outputs = {{"torque", "N m", "air gap torque", params.rated_torque_Nm},
                     {"i_alpha", "A", "stator current, real part", m_.rated_peak_current},
                     {"i_beta", "A", "stator current, imaginary part", m_.rated_peak_current},
                     {"flux", "V s", "magnitude of the rotor flux", m_.rated_flux}};
  layout_.states = {{"i_alpha", "A", "stator current, real part", m_.rated_peak_current},
                    {"i_beta", "A", "stator current, imaginary part", m_.rated_peak_current},
                    {"psi_alpha", "V s", "rotor flux, real part", m_.rated_flux},
                    {"psi_beta", "V s", "rotor flux, imaginary part", m_.rated_flux}};
}

void InductionMachine::Start(std::span<const double>, std::span<double> states, std::span<int>) const {
  states[0] = m_.rated_i_d;
  states[1] = initial_torque_ / m_.TorquePerAmpere(m_.rated_flux);
  states[2] = m_.rated_flux;
  states[3] = 0.0;
}

void InductionMachine::Output(const View& view, std::span<double> outputs) const {
  const double* x = view.states.data();
  outputs[0] = 1.5 * m_.pole_pairs * (x[2] * x[1] - x[3] * x[0]);
  outputs[1] = x[0];
  outputs[2] = x[1];
  outputs[3] = std::sqrt(x[2] * x[2] + x[3] * x[3]);
}

void InductionMachine::Derivative(const View& view, std::span<double> rates) const {
  // di/dt with dpsi/dt put in, so that no rate waits for another: this chain is what a step of the machine costs.
  const double* x = view.states.data();
  const double nu = m_.pole_pairs * view.inputs[2];
  rates[0] = (inverse_leakage_ * view.inputs[0] - damping_ * x[0]) + (transfer_ * x[2] + inverse_leakage_ * nu * x[3]);
  rates[1] = (inverse_leakage_ * view.inputs[1] - damping_ * x[1]) + (transfer_ * x[3] - inverse_leakage_ * nu * x[2]);
  rates[2] = (m_.R_R * x[0] - rotor_rate_ * x[2]) - nu * x[3];
  rates[3] = (m_.R_R * x[1] - rotor_rate_ * x[3]) + nu * x[2];
}

}  // namespace dynoproof
