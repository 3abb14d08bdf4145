#include "control10k/torque_control.h"

#include <cmath>
#include <type_traits>

namespace control10k {
namespace {

static_assert(std::is_trivially_copyable_v<TorqueState> && std::is_standard_layout_v<TorqueState>);

constexpr double kTurn = 6.283185307179586;

/// A space vector, real and imaginary part; std::complex would call a library for the infinities of a product.
struct Phasor {
  double re, im;
};
Phasor operator+(Phasor a, Phasor b) { return {a.re + b.re, a.im + b.im}; }
Phasor operator-(Phasor a, Phasor b) { return {a.re - b.re, a.im - b.im}; }
Phasor operator*(double s, Phasor a) { return {s * a.re, s * a.im}; }
Phasor operator*(Phasor a, Phasor b) { return {a.re * b.re - a.im * b.im, a.re * b.im + a.im * b.re}; }
Phasor Conjugate(Phasor a) { return {a.re, -a.im}; }
Phasor Unit(double angle) { return {std::cos(angle), std::sin(angle)}; }
double Size(Phasor a) { return std::sqrt(a.re * a.re + a.im * a.im); }

double Clamp(double value, double low, double high) { return value < low ? low : value > high ? high : value; }

}  // namespace

bool IsUsable(const TorqueConfig& c) {
  const MachineModel& m = c.machine;
  return m.R_s > 0.0 && m.R_R > 0.0 && m.L_M > 0.0 && m.L_sigma > 0.0 && m.pole_pairs >= 1.0 && m.rated_flux > 0.0 &&
         m.rated_i_d > 0.0 && m.rated_peak_current >= m.rated_i_d && c.period_s > 0.0 && c.current_bandwidth_Hz > 0.0 &&
         c.flux_bandwidth_Hz > 0.0 && c.dc_link_V > 0.0 && c.overload >= 1.0;
}

TorqueControl::TorqueControl(const TorqueConfig& config)
    : m_(config.machine), period_s_(config.period_s), initial_torque_(config.initial_torque_Nm) {
  const double bandwidth = kTurn * config.current_bandwidth_Hz, flux_bandwidth = kTurn * config.flux_bandwidth_Hz;
  flux_decay_ = std::exp(-m_.rotor_rate() * period_s_);
  voltage_limit_ = config.dc_link_V / std::sqrt(3.0);
  current_limit_ = config.overload * m_.rated_peak_current;
  gain_ = bandwidth * m_.L_sigma;
  reset_ = bandwidth * (m_.R_s + m_.R_R);
  flux_gain_ = flux_bandwidth / m_.R_R;
  flux_reset_ = flux_bandwidth / m_.L_M;
}

void TorqueControl::Begin(TorqueState& state, double speed) const {
  // The machine stands at its operating point: rated flux along alpha, torque as told, all integrals settled.
  const double i_d = m_.rated_i_d, i_q = initial_torque_ / m_.TorquePerAmpere(m_.rated_flux);
  const double nu = m_.pole_pairs * speed + m_.R_R * i_q / m_.rated_flux;
  state = {};
  state.begun = 1.0;
  state.flux_Vs = m_.rated_flux;
  state.integral_d_V = m_.R_s * i_d;
  state.integral_q_V = m_.R_s * i_q;
  const Phasor wanted =
      Phasor{m_.R_s * i_d - nu * m_.L_sigma * i_q, m_.R_s * i_q + nu * (m_.L_sigma * i_d + m_.rated_flux)} *
      Unit(0.5 * nu * period_s_);
  const double size = Size(wanted);
  const Phasor u = size > voltage_limit_ ? (voltage_limit_ / size) * wanted : wanted;
  state.next_alpha_V = u.re;
  state.next_beta_V = u.im;
}

TorqueOutputs TorqueControl::Step(TorqueState& state, const TorqueInputs& in) const {
  if (state.begun == 0.0) Begin(state, in.speed_rad_per_s);
  // Currents in the frame of the flux.
  const Phasor frame = Unit(state.angle_rad);
  const Phasor i = Phasor{in.i_alpha_A, in.i_beta_A} * Conjugate(frame);
  const double least = 0.05 * m_.rated_flux, psi = state.flux_Vs < least ? least : state.flux_Vs;
  const double slip = m_.R_R * i.im / psi, nu = m_.pole_pairs * in.speed_rad_per_s + slip;

  // Flux and torque to currents; the flux comes first, the torque takes what the limit leaves.
  const double flux_error = m_.rated_flux - psi;
  const double i_d_free = m_.rated_i_d + flux_gain_ * flux_error + state.integral_flux_A;
  const double i_d_set = Clamp(i_d_free, 0.0, 0.9 * current_limit_);
  if (i_d_set == i_d_free) state.integral_flux_A += period_s_ * flux_reset_ * flux_error;
  const double i_q_most = std::sqrt(current_limit_ * current_limit_ - i_d_set * i_d_set);
  const double i_q_set = Clamp(in.torque_set_Nm / m_.TorquePerAmpere(psi), -i_q_most, i_q_most);

  // Currents to voltage: PI, decoupling, back-EMF.
  const Phasor error = Phasor{i_d_set, i_q_set} - i, integral{state.integral_d_V, state.integral_q_V};
  const double flux_rate = m_.R_R * i.re - m_.rotor_rate() * psi;
  const Phasor ahead{flux_rate - nu * m_.L_sigma * i.im, nu * (psi + m_.L_sigma * i.re)};
  const Phasor wanted = gain_ * error + integral + ahead;
  const double size = Size(wanted);
  const Phasor u = size > voltage_limit_ ? (voltage_limit_ / size) * wanted : wanted;
  // What the limit took away goes back into the integral, so that it does not wind up.
  const Phasor grown = integral + (period_s_ * reset_) * (error + (1.0 / gain_) * (u - wanted));
  state.integral_d_V = grown.re;
  state.integral_q_V = grown.im;

  const TorqueOutputs out{state.next_alpha_V, state.next_beta_V, m_.TorquePerAmpere(psi) * i.im, i_q_set};
  // It acts from the next step on for a period: in the middle of that the frame has turned on by 1.5 periods.
  const Phasor given = u * (frame * Unit(1.5 * nu * period_s_));
  state.next_alpha_V = given.re;
  state.next_beta_V = given.im;

  // The current model over the period, with the currents of its beginning.
  state.flux_Vs = state.flux_Vs * flux_decay_ + m_.L_M * i.re * (1.0 - flux_decay_);
  const double angle = state.angle_rad + nu * period_s_;
  state.angle_rad = angle > kTurn ? angle - kTurn : angle < -kTurn ? angle + kTurn : angle;
  return out;
}

}  // namespace control10k
