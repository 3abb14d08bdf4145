#include "plugins/control/machine_control/machine_control.h"

#include <algorithm>
#include <complex>
#include <numbers>

namespace dynoproof::controls {

using Phasor = std::complex<double>;

namespace {

/// Products without the library's care for infinities.
Phasor Times(Phasor a, Phasor b) {
  return {a.real() * b.real() - a.imag() * b.imag(), a.real() * b.imag() + a.imag() * b.real()};
}
Phasor Unit(double angle) { return {std::cos(angle), std::sin(angle)}; }

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

RotorFluxControl::RotorFluxControl(const Params& params, const BuildContext& context)
    : period_s_(context.period_s), initial_torque_(params.initial_torque_Nm) {
  params.Derive(m_);
  const double bandwidth = 2.0 * std::numbers::pi * params.current_bandwidth_Hz;
  flux_decay_ = std::exp(-m_.rotor_rate() * period_s_);
  voltage_limit_ = params.dc_link_V / std::sqrt(3.0);
  current_limit_ = params.overload * m_.rated_peak_current;
  gain_ = bandwidth * m_.L_sigma;
  reset_ = bandwidth * (m_.R_s + m_.R_R);
  const double flux_bandwidth = 2.0 * std::numbers::pi * params.flux_bandwidth_Hz;
  flux_gain_ = flux_bandwidth / m_.R_R;
  flux_reset_ = flux_bandwidth / m_.L_M;
  const double volts = voltage_limit_, amperes = m_.rated_peak_current;
  layout_.inputs = {{"torque", "N m", "set point", params.rated_torque_Nm},
                    {"i_alpha", "A", "measured current, real part", amperes},
                    {"i_beta", "A", "measured current, imaginary part", amperes},
                    {"speed", "rad/s", "measured speed", params.rated_speed_rad_per_s}};
  layout_.outputs = {{"u_alpha", "V", "voltage for the coming period, real part", volts},
                     {"u_beta", "V", "voltage for the coming period, imaginary part", volts},
                     {"torque", "N m", "estimated torque", params.rated_torque_Nm},
                     {"i_q_set", "A", "set point of the torque-forming current", amperes}};
  layout_.states = {{"begun", "1", "0 before the first tick", 1.0},
                    {"angle", "rad", "angle of the rotor flux", 1.0},
                    {"flux", "V s", "magnitude of the rotor flux", m_.rated_flux},
                    {"integral_d", "V", "of the controller of i_d", volts},
                    {"integral_q", "V", "of the controller of i_q", volts},
                    {"integral_flux", "A", "of the flux controller", amperes},
                    {"next_alpha", "V", "voltage that was computed last, real part", volts},
                    {"next_beta", "V", "voltage that was computed last, imaginary part", volts}};
}

void RotorFluxControl::Begin(double speed, std::span<double> states) const {
  // The machine stands at its operating point: rated flux along alpha, torque as told, all integrals settled.
  const double i_d = m_.rated_i_d, i_q = initial_torque_ / m_.TorquePerAmpere(m_.rated_flux);
  const double nu = m_.pole_pairs * speed + m_.R_R * i_q / m_.rated_flux;
  states[kBegun] = 1.0;
  states[kFlux] = m_.rated_flux;
  states[kIntegralD] = m_.R_s * i_d;
  states[kIntegralQ] = m_.R_s * i_q;
  const Phasor wanted =
      Phasor(m_.R_s * i_d - nu * m_.L_sigma * i_q, m_.R_s * i_q + nu * (m_.L_sigma * i_d + m_.rated_flux)) *
      Unit(0.5 * nu * period_s_);
  const Phasor u = wanted * std::min(1.0, voltage_limit_ / std::sqrt(std::norm(wanted)));
  states[kNextAlpha] = u.real();
  states[kNextBeta] = u.imag();
}

void RotorFluxControl::Tick(const View& view, std::span<double> states, std::span<double> outputs) const {
  const double torque_set = view.inputs[0], speed = view.inputs[3];
  if (states[kBegun] == 0.0) Begin(speed, states);
  // Currents in the frame of the flux.
  const Phasor frame = Unit(states[kAngle]);
  const Phasor i = Times({view.inputs[1], view.inputs[2]}, std::conj(frame));
  const double psi = std::max(states[kFlux], 0.05 * m_.rated_flux);
  const double slip = m_.R_R * i.imag() / psi, nu = m_.pole_pairs * speed + slip;

  // Flux and torque to currents; the flux comes first, the torque takes what the limit leaves.
  const double flux_error = m_.rated_flux - psi;
  const double i_d_free = m_.rated_i_d + flux_gain_ * flux_error + states[kIntegralFlux];
  const double i_d_set = std::clamp(i_d_free, 0.0, 0.9 * current_limit_);
  if (i_d_set == i_d_free) states[kIntegralFlux] += period_s_ * flux_reset_ * flux_error;
  const double i_q_most = std::sqrt(current_limit_ * current_limit_ - i_d_set * i_d_set);
  const double i_q_set = std::clamp(torque_set / m_.TorquePerAmpere(psi), -i_q_most, i_q_most);

  // Currents to voltage: PI, decoupling, back-EMF.
  const Phasor error = Phasor(i_d_set, i_q_set) - i, integral(states[kIntegralD], states[kIntegralQ]);
  const double flux_rate = m_.R_R * i.real() - m_.rotor_rate() * psi;
  const Phasor ahead(flux_rate - nu * m_.L_sigma * i.imag(), nu * (psi + m_.L_sigma * i.real()));
  const Phasor wanted = gain_ * error + integral + ahead;
  const double size = std::sqrt(std::norm(wanted));
  const Phasor u = size > voltage_limit_ ? wanted * (voltage_limit_ / size) : wanted;
  // What the limit took away goes back into the integral, so that it does not wind up.
  const Phasor grown = integral + period_s_ * reset_ * (error + (u - wanted) / gain_);
  states[kIntegralD] = grown.real();
  states[kIntegralQ] = grown.imag();

  outputs[0] = states[kNextAlpha];
  outputs[1] = states[kNextBeta];
  outputs[2] = m_.TorquePerAmpere(psi) * i.imag();
  outputs[3] = i_q_set;
  // It acts from the next tick on for a period: in the middle of that the frame has turned on by 1.5 periods.
  const Phasor given = Times(u, Times(frame, Unit(1.5 * nu * period_s_)));
  states[kNextAlpha] = given.real();
  states[kNextBeta] = given.imag();

  // The current model over the period, with the currents of its beginning.
  states[kFlux] = states[kFlux] * flux_decay_ + m_.L_M * i.real() * (1.0 - flux_decay_);
  constexpr double kTurn = 2.0 * std::numbers::pi;
  const double angle = states[kAngle] + nu * period_s_;
  states[kAngle] = angle > kTurn ? angle - kTurn : angle < -kTurn ? angle + kTurn : angle;
}

}  // namespace dynoproof::controls
