// Formulas whose print has slipped: each study gives how far the formula is from what it stands for, as printed or as
// it should read. Nothing here uses the engine's own versions of them.
#include "thesis/studies_slips.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>
#include <vector>

#include "thesis/constants.h"

namespace dynoproof {
namespace {

using Complex = std::complex<double>;

bool AsPrinted(const Value& parameters) {
  const Value* value = parameters.Find("as_printed");
  return value != nullptr && value->is_bool() && value->boolean();
}

constexpr double kI1 = 4.8, kI2 = 0.2, kK = 6e6, kC = 125.0;  // a two-mass oscillator

/// T_shaft over T_airgap of the state space (2.10) against P1 of (2.2): largest relative distance.
Result<Figure> MixedStates(const Registry&, const Value& parameters) {
  Eigen::Matrix3cd A;
  A << 0.0, 1.0, -1.0, -kK / kI1, -kC / kI1, kC / kI1, kK / kI2, kC / kI2, -kC / kI2;
  Eigen::Vector3cd b = Eigen::Vector3cd::Zero();
  b(AsPrinted(parameters) ? 2 : 1) = 1.0 / kI1;
  const Eigen::RowVector3cd output(kK, kC, -kC);
  double worst = 0.0;
  for (double f = 1.0; f < 3000.0; f *= 1.3) {
    const Complex s(0.0, kTurn * f);
    const Complex states = (output * (s * Eigen::Matrix3cd::Identity() - A).partialPivLu().solve(b)).value();
    const double sum = 1.0 / kI1 + 1.0 / kI2;
    const Complex right = (kC * s + kK) / kI1 / (s * s + kC * sum * s + kK * sum);
    worst = std::max(worst, std::abs(states - right) / std::abs(right));
  }
  return Figure{worst, "1"};
}

/// Real part of the eigenvalues of A_Delta (2.32) over that of (2.13).
Result<Figure> DifferentialDamping(const Registry&, const Value& parameters) {
  const double sum = 1.0 / kI1 + 1.0 / kI2;
  Eigen::Matrix2d A;
  A << 0.0, 1.0, -kK * sum, AsPrinted(parameters) ? kC * sum : -kC * sum;
  const Eigen::Vector2cd eigenvalues = A.eigenvalues();
  return Figure{eigenvalues(0).real() / (-0.5 * kC * sum), "1"};
}

/// How far the exchange matrix P of (2.26) for three masses, times its inverse as printed (P itself) or P^T, is from
/// the unit matrix.
Result<Figure> ExchangeMatrix(const Registry&, const Value& parameters) {
  constexpr int kHalf = 3;
  Eigen::MatrixXd P = Eigen::MatrixXd::Zero(2 * kHalf, 2 * kHalf);
  for (int i = 0; i < kHalf; ++i) {
    P(i, 2 * i) = 1.0;              // angles first
    P(kHalf + i, 2 * i + 1) = 1.0;  // speeds behind them
  }
  const Eigen::MatrixXd inverse = AsPrinted(parameters) ? P : Eigen::MatrixXd(P.transpose());
  return Figure{(P * inverse - Eigen::MatrixXd::Identity(2 * kHalf, 2 * kHalf)).cwiseAbs().maxCoeff(), "1"};
}

/// Output of the filter (5.8) at nu_0 after a tone.
double FilterOutput(double nu_0) {
  const double r = 0.9, c = std::cos(nu_0);
  double u[3] = {}, y[3] = {};
  for (int n = 0; n < 200; ++n) {
    u[2] = u[1], u[1] = u[0], u[0] = std::sin(0.7 * n);
    y[2] = y[1], y[1] = y[0];
    y[0] = u[0] - 2.0 * c * u[1] + u[2] + 2.0 * r * c * y[1] - r * r * y[2];
  }
  return y[0];
}

/// The gradient that (5.12) descends, 2 y beta as printed or y beta, over that of the stated cost y^2/2.
Result<Figure> CostGradient(const Registry&, const Value& parameters) {
  const double nu_0 = 0.5, h = 1e-5;
  const double y = FilterOutput(nu_0), beta = (FilterOutput(nu_0 + h) - FilterOutput(nu_0 - h)) / (2.0 * h);
  const auto cost = [](double nu) { return 0.5 * FilterOutput(nu) * FilterOutput(nu); };
  return Figure{(AsPrinted(parameters) ? 2.0 : 1.0) * y * beta / ((cost(nu_0 + h) - cost(nu_0 - h)) / (2.0 * h)), "1"};
}

/// The fraction (5.18) by its second form, with a plus as printed or a minus, over its first.
Result<Figure> LobeFraction(const Registry&, const Value& parameters) {
  const double delta = 0.3, N = 128.0, pi = std::numbers::pi;
  const auto entry = [&](double at, double shift) {
    return std::abs(std::sin(pi * delta + shift)) / std::abs(std::sin(pi / N * at));
  };
  const double next = entry(delta - 1.0, -pi), before = entry(delta + 1.0, pi);
  const double second = AsPrinted(parameters) ? next + before : next - before;
  const auto direct = [&](double at) { return std::abs(std::sin(pi * at)) / std::abs(std::sin(pi / N * at)); };
  return Figure{second / (direct(delta - 1.0) - direct(delta + 1.0)), "1"};
}

/// The recursion (5.30) with cos(2 pi k N) as printed or cos(2 pi k / N), against the sum (5.15): relative distance.
Result<Figure> GoertzelRecursion(const Registry&, const Value& parameters) {
  const int N = 128, k = 8;
  const double turn = AsPrinted(parameters) ? kTurn * k * N : kTurn * k / N;
  double y = 0.0, before = 0.0;
  Complex sum = 0.0;
  for (int n = 0; n < N; ++n) {
    const double x = std::sin(0.37 * n + 0.2), next = 2.0 * std::cos(turn) * y - before + x;
    before = y;
    y = next;
    sum += x * std::polar(1.0, -kTurn * k * n / N);
  }
  const Complex last = y - std::polar(1.0, kTurn * k / N) * before;
  return Figure{std::abs(std::abs(last) - std::abs(sum)) / std::abs(sum), "1"};
}

/// dp_ch/dt of (6.17) less that of (6.3), over that of the engine's flow alone.
Result<Figure> ChargeBalance(const Registry&, const Value& parameters) {
  const double rate = 287.05 * 320.0 / 0.4, q_1 = 1.1, q_e = 0.9;
  const double delta = (AsPrinted(parameters) ? 1.0 : -1.0) * rate * q_e;
  return Figure{(rate * q_1 + delta - rate * (q_1 - q_e)) / (rate * q_e), "1"};
}

/// dp_g/dt of (6.29) less that of (6.23) with (6.25), over that of d_q alone.
Result<Figure> GasBalance(const Registry&, const Value& parameters) {
  const double rate = 518.0 * 300.0 / 0.02, k_q = 35.9, x = 1e-3, d_q = 0.03, q_e = 0.05;
  const double entry = AsPrinted(parameters) ? 1.0 : rate;
  return Figure{(k_q * rate * x - rate * q_e + entry * d_q - rate * (k_q * x + d_q - q_e)) / (rate * d_q), "1"};
}

/// The loop of (6.30) and (6.33), with (k_P s + k_P)/s as printed or (k_P s + k_I)/s, against (6.34): largest relative
/// distance.
Result<Figure> GasController(const Registry&, const Value& parameters) {
  const double a_3 = 800.0, a_2 = 4e4, g = 1.1e7, k_P = 0.2, k_I = 5.0;
  double worst = 0.0;
  for (double w = 0.1; w < 1e3; w *= 1.3) {
    const Complex s(0.0, w), plant = g / (s * s * s + a_3 * s * s + a_2 * s + g);
    const Complex control = (k_P * s + (AsPrinted(parameters) ? k_P : k_I)) / s;
    const Complex loop = plant * (1.0 + control) / (1.0 + plant * control);
    const Complex right = ((1.0 + k_P) * g * s + k_I * g) /
                          (s * s * s * s + a_3 * s * s * s + a_2 * s * s + (1.0 + k_P) * g * s + k_I * g);
    worst = std::max(worst, std::abs(loop - right) / std::abs(right));
  }
  return Figure{worst, "1"};
}

/// T_zero over omega_2 by (2.86), with k1 or another stiffness in the denominator, against the equation of motion of I1
/// on its shaft: largest relative distance.
Result<Figure> ZeroBlock(const Registry&, const Value& parameters) {
  const double inner = AsPrinted(parameters) ? 2.0 * kK : kK;
  Eigen::Matrix2cd A;  // of the twist of the shaft and the speed of I1
  A << 0.0, 1.0, -kK / kI1, 0.0;
  const Eigen::Vector2cd b(-1.0, 0.0);
  double worst = 0.0;
  for (double f = 1.0; f < 3000.0; f *= 1.3) {
    const Complex s(0.0, kTurn * f);
    const Complex motion = kK * (s * Eigen::Matrix2cd::Identity() - A).partialPivLu().solve(b)(0);
    worst = std::max(worst, std::abs(-kK * s / (s * s + inner / kI1) / motion - 1.0));
  }
  return Figure{worst, "1"};
}

constexpr double kGapK = 50.0, kGapC = 0.4, kGapFree = 0.6, kAlpha = 0.02, kRate = 2.0;  // a shaft with play

/// phi_b of (3.10) when contact on the right is lost, with the sign of (3.11) that its order of sides names, or the
/// other one: distance from alpha over alpha.
Result<Figure> GapConstant(const Registry&, const Value& parameters) {
  const double sum = kGapC + kGapFree, start = kAlpha - kGapC / kGapK * kRate;  // (3.6) with omega_b = 0
  const double p = kGapK / sum, q = kGapK / sum * start + kGapC / sum * kRate, r = kGapK / sum * kRate;
  const double C = (AsPrinted(parameters) ? -kAlpha : kAlpha) + (r - p * q) / (p * p);
  return Figure{((p * q - r) / (p * p) + C - kAlpha) / kAlpha, "1"};
}

/// The speed at the gap when contact on the left is lost, with phi_d - alpha or phi_d + alpha in the exponent of (3.14),
/// over omega_d. The speed is the derivative of (3.10).
Result<Figure> GapSides(const Registry&, const Value& parameters) {
  const double start = -kAlpha - kGapC / kGapK * kRate;  // (3.6) with omega_b = 0
  const double since = (start + (AsPrinted(parameters) ? -kAlpha : kAlpha)) / kRate + kGapC / kGapK;
  return Figure{-std::expm1(-kGapK / (kGapC + kGapFree) * since), "1"};
}

}  // namespace

std::map<std::string, Study, std::less<>> SlipStudies() {
  return {{"slip_charge_balance", ChargeBalance},
          {"slip_cost_gradient", CostGradient},
          {"slip_differential_damping", DifferentialDamping},
          {"slip_exchange_matrix", ExchangeMatrix},
          {"slip_gap_constant", GapConstant},
          {"slip_gap_sides", GapSides},
          {"slip_gas_balance", GasBalance},
          {"slip_gas_controller", GasController},
          {"slip_goertzel", GoertzelRecursion},
          {"slip_lobe_fraction", LobeFraction},
          {"slip_mixed_states", MixedStates},
          {"slip_zero_block", ZeroBlock}};
}

}  // namespace dynoproof
