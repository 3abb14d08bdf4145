#include "plugins/control/rotor_flux_control/rotor_flux_control.h"

#include <cstring>

namespace dynoproof::controls {
namespace {

using control10k::TorqueState;
static_assert(sizeof(TorqueState) == 9 * sizeof(double));  // the states below, in this order

}  // namespace

PluginInfo RotorFluxControl::Info() {
  return {
      "control",
      "rotor_flux_control",
      "torque of an induction machine by rotor-flux orientation, with averaged PWM",
      "current model of the flux; i_d = psi/L_M + PI, i_q = T/(1.5 p psi); u = PI + decoupling, |u| <= u_dc/sqrt(3), "
      "given one tick later",
      "thesis Secs. 2.1.2, 3.1 (names the controllers); tuning: internal model, README",
      {}};
}

control10k::TorqueConfig RotorFluxControl::Params::Config(double period_s) const {
  control10k::TorqueConfig config;
  Derive(config.machine);
  config.period_s = period_s;
  config.current_bandwidth_Hz = current_bandwidth_Hz;
  config.flux_bandwidth_Hz = flux_bandwidth_Hz;
  config.dc_link_V = dc_link_V;
  config.overload = overload;
  config.initial_torque_Nm = initial_torque_Nm;
  return config;
}

RotorFluxControl::RotorFluxControl(const Params& params, const BuildContext& context)
    : control_(params.Config(context.period_s)) {
  MachineModel machine;
  params.Derive(machine);
  const double volts = params.dc_link_V / std::sqrt(3.0), amperes = machine.rated_peak_current;
  layout_.inputs = {{"torque", "N m", "set point", params.rated_torque_Nm},
                    {"i_alpha", "A", "measured current, real part", amperes},
                    {"i_beta", "A", "measured current, imaginary part", amperes},
                    {"speed", "rad/s", "measured speed", params.rated_speed_rad_per_s}};
  layout_.outputs = {{"u_alpha", "V", "voltage for the coming period, real part", volts},
                     {"u_beta", "V", "voltage for the coming period, imaginary part", volts},
                     {"torque", "N m", "estimated torque", params.rated_torque_Nm},
                     {"i_q_set", "A", "set point of the torque-forming current", amperes}};
  layout_.states = {{"begun", "1", "0 before the first tick", 1.0},
                    {"frame_alpha", "1", "unit vector along the rotor flux, real part", 1.0},
                    {"frame_beta", "1", "the same, imaginary part", 1.0},
                    {"flux", "V s", "magnitude of the rotor flux", machine.rated_flux},
                    {"integral_d", "V", "of the controller of i_d", volts},
                    {"integral_q", "V", "of the controller of i_q", volts},
                    {"integral_flux", "A", "of the flux controller", amperes},
                    {"next_alpha", "V", "voltage that was computed last, real part", volts},
                    {"next_beta", "V", "voltage that was computed last, imaginary part", volts}};
}

void RotorFluxControl::Tick(const View& view, std::span<double> states, std::span<double> outputs) const {
  TorqueState state;
  std::memcpy(static_cast<void*>(&state), states.data(), sizeof state);
  const auto out = control_.Step(state, {view.inputs[0], view.inputs[1], view.inputs[2], view.inputs[3]});
  std::memcpy(states.data(), &state, sizeof state);
  outputs[0] = out.u_alpha_V;
  outputs[1] = out.u_beta_V;
  outputs[2] = out.torque_Nm;
  outputs[3] = out.i_q_set_A;
}

}  // namespace dynoproof::controls
