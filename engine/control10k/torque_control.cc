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
/// The unit vector at an angle. The frame turns by less than half a radian in a period or two; the series to the ninth
/// power is exact to 2e-11 there, and costs a fifth of the library's functions.
Phasor Turn(double x) {
  if (!(std::abs(x) < 0.5)) return {std::cos(x), std::sin(x)};
  const double y = x * x;
  return {1.0 - y * (1.0 / 2 - y * (1.0 / 24 - y * (1.0 / 720 - y * (1.0 / 40320 - y / 3628800)))),
          x * (1.0 - y * (1.0 / 6 - y * (1.0 / 120 - y * (1.0 / 5040 - y * (1.0 / 362880)))))};
}
/// Shortened to the limit with its angle kept.
Phasor Limited(Phasor a, double limit) {
  const double square = a.re * a.re + a.im * a.im;
  return square > limit * limit ? (limit / std::sqrt(square)) * a : a;
}

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
  inverse_gain_ = 1.0 / gain_;
  rotor_rate_ = m_.rotor_rate();
  ampere_per_torque_flux_ = 1.0 / m_.TorquePerAmpere(1.0);
  // R_R i stands in the voltage fed ahead (flux_rate and slip below): the pole that the controllers meet is R_s /
  // L_sigma.
  reset_ = bandwidth * m_.R_s;
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
      Turn(0.5 * nu * period_s_);
  const Phasor u = Limited(wanted, voltage_limit_);
  state.next_alpha_V = u.re;
  state.next_beta_V = u.im;
}

TorqueOutputs TorqueControl::Step(TorqueState& state, const TorqueInputs& in) const {
  if (state.begun == 0.0) Begin(state, in.speed_rad_per_s);
  // Currents in the frame of the flux.
  const Phasor frame{state.frame_alpha, state.frame_beta};
  const Phasor i = Phasor{in.i_alpha_A, in.i_beta_A} * Conjugate(frame);
  const double least = 0.05 * m_.rated_flux, psi = state.flux_Vs < least ? least : state.flux_Vs;
  const double by_flux = 1.0 / psi;
  const double slip = m_.R_R * i.im * by_flux, nu = m_.pole_pairs * in.speed_rad_per_s + slip;

  // Flux and torque to currents; the flux comes first, the torque takes what the limit leaves.
  const double flux_error = m_.rated_flux - psi;
  const double i_d_free = m_.rated_i_d + flux_gain_ * flux_error + state.integral_flux_A;
  const double i_d_set = Clamp(i_d_free, 0.0, 0.9 * current_limit_);
  if (i_d_set == i_d_free) state.integral_flux_A += period_s_ * flux_reset_ * flux_error;
  const double i_q_most = std::sqrt(current_limit_ * current_limit_ - i_d_set * i_d_set);
  const double i_q_set = Clamp(in.torque_set_Nm * ampere_per_torque_flux_ * by_flux, -i_q_most, i_q_most);

  // Currents to voltage: PI, decoupling, back-EMF.
  const Phasor error = Phasor{i_d_set, i_q_set} - i, integral{state.integral_d_V, state.integral_q_V};
  const double flux_rate = m_.R_R * i.re - rotor_rate_ * psi;
  const Phasor ahead{flux_rate - nu * m_.L_sigma * i.im, nu * (psi + m_.L_sigma * i.re)};
  const Phasor wanted = gain_ * error + integral + ahead;
  const Phasor u = Limited(wanted, voltage_limit_);
  // What the limit took away goes back into the integral, so that it does not wind up.
  const Phasor grown = integral + (period_s_ * reset_) * (error + inverse_gain_ * (u - wanted));
  state.integral_d_V = grown.re;
  state.integral_q_V = grown.im;

  const TorqueOutputs out{state.next_alpha_V, state.next_beta_V, m_.TorquePerAmpere(psi) * i.im, i_q_set};
  // It acts from the next step on for a period: in the middle of that the frame has turned on by 1.5 periods.
  const Phasor given = u * (frame * Turn(1.5 * nu * period_s_));
  state.next_alpha_V = given.re;
  state.next_beta_V = given.im;

  // The current model over the period, with the currents of its beginning.
  state.flux_Vs = state.flux_Vs * flux_decay_ + m_.L_M * i.re * (1.0 - flux_decay_);
  // The product of unit vectors is one but for round-off, which the last factor takes away before it can add up.
  const Phasor next = frame * Turn(nu * period_s_);
  const Phasor turned = (1.5 - 0.5 * (next.re * next.re + next.im * next.im)) * next;
  state.frame_alpha = turned.re;
  state.frame_beta = turned.im;
  return out;
}

}  // namespace control10k
