#include "control10k/notch.h"

#include <cmath>

namespace control10k {

bool DesignNotch(double nu_0, double r, NotchCoefficients& coefficients) {
  coefficients = {};
  if (!(nu_0 > 0.0 && nu_0 < 3.14159265358979323846 && r > 0.0 && r <= 1.0)) return false;
  if (r == 1.0) return true;
  // K with 1 - cos = 2 sin^2(nu_0 / 2), which loses no digits at low frequencies.
  const double s = std::sin(0.5 * nu_0), c = std::cos(nu_0), d = 4.0 * s * s;
  const double K = ((1.0 - r) * (1.0 - r) + r * d) / d;
  coefficients = {K, -2.0 * K * c, K, -2.0 * r * c, r * r};
  return true;
}

double NyquistGain(double nu_0, double r) {
  const double c = std::cos(nu_0), m = 0.5 * (1.0 + r * r);
  return std::abs(1.0 + c) / std::abs(1.0 - c) * std::abs(m - r * c) / std::abs(m + r * c);
}

bool Notch::Retune(double new_nu_0, double new_r, double u) {
  NotchCoefficients next;
  if (!DesignNotch(new_nu_0, new_r, next)) return false;
  const auto output = [&](const NotchCoefficients& f) {
    return f.b0 * u + f.b1 * u1 + f.b2 * u2 - f.a1 * y1 - f.a2 * y2;
  };
  bump += output(c) - output(next);
  c = next;
  nu_0 = new_nu_0;
  r = new_r;
  return true;
}

}  // namespace control10k
