// The notch filter (5.1), (D.1) and a cascade of them. Coefficients change without a jump in the output.
//
//   H(z) = K (1 - 2 cos(nu_0) / z + 1 / z^2) / (1 - 2 r cos(nu_0) / z + r^2 / z^2),   H(1) = 1
//
// nu_0 = 2 pi f T_d is the notch frequency, r the pole radius. At r = 1 numerator and denominator cancel: the filter is
// then switched off, not left with poles on the unit circle. nu_0 = 0 has no K and is refused.
#pragma once

namespace control10k {

inline constexpr double kTwoPi = 6.28318530717958647692;  // rad of a turn

/// Below this radius the gain (D.7) at the Nyquist frequency amplifies the noise of the measurement: a warning.
inline constexpr double kSmallestAdvisableRadius = 0.95;
inline constexpr int kMaxNotches = 6;

/// y(n) = b0 u(n) + b1 u(n-1) + b2 u(n-2) - a1 y(n-1) - a2 y(n-2). As it stands: no filter.
struct NotchCoefficients {
  double b0 = 1.0, b1 = 0.0, b2 = 0.0, a1 = 0.0, a2 = 0.0;
};

/// False, and no filter, unless 0 < nu_0 < pi and 0 < r <= 1.
bool DesignNotch(double nu_0, double r, NotchCoefficients& coefficients);

/// (D.7): the gain at the Nyquist frequency.
double NyquistGain(double nu_0, double r);

/// One filter at work. Only doubles, so that a whole state can be saved, compared and logged as an array.
struct Notch {
  NotchCoefficients c;
  double u1 = 0.0, u2 = 0.0, y1 = 0.0, y2 = 0.0;  // last inputs and outputs
  double bump = 0.0;                              // what keeps the output from jumping; fades
  double nu_0 = 0.0, r = 1.0;

  double Step(double u) {
    const double y = c.b0 * u + c.b1 * u1 + c.b2 * u2 - c.a1 * y1 - c.a2 * y2;
    u2 = u1;
    u1 = u;
    y2 = y1;
    y1 = y;
    const double out = y + bump;
    bump *= kFade;
    return out;
  }
  /// Takes new values from the step with input u on, whose output stays what it would have been: the difference is
  /// added and fades with a time constant of 50 samples, short against the 200 samples of a filter with r = 0.995 and
  /// long enough to be no step. False, and no change, when the values make no filter.
  bool Retune(double new_nu_0, double new_r, double u);

  static constexpr double kFade = 0.98;
};

}  // namespace control10k
