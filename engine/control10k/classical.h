// The adaptive notch filters that the thesis reviews (Sec. 5.3, 5.4.1), for comparison. Each estimates its notch
// frequency nu_0 from sample to sample; the torque then passes the notch (5.8), (5.1) at nu_0. Several in series: each
// works on the output of the one before it.
//
//   kComplexGradient     (5.2), (5.4)   nu_0 += mu Im[y conj(u)] of the complex notch, divided by the mean of u^2
//   kContinuousGradient  (5.6)          nu_0' = -mu nu_0 LP(u) N(u), divided by the mean of u^2. As printed, y(u - r
//   nu_0 y)
//                                       mixes quantities of unlike units; it becomes the notch of Hsu, Ortega and Damm
//                                       when y is the filter's state: LP its low-pass, N its notch output
//   kBalance             (5.7)          nu_0' = -mu nu_0 (|LP| - |BP|) / (|LP| + |BP|), means of both: what is left of
//                                       |nu_0 y| - sqrt(u y) when the root of a negative product is to mean a
//                                       magnitude; low-pass and band-pass are equally high exactly at nu_0
//   kLms                 (5.8)-(5.12)   nu_0 -= 2 mu y beta, beta = dy/dnu_0, as printed with its factor 2 (the cost as
//                                       stated gives mu y beta, half of it)
//   kBandPassPair        (5.13), (5.14) nu_0 += Delta sign(sum y_h^2 - sum y_l^2) over M + 1 samples; a tie moves
//   nothing
#pragma once

#include "control10k/notch.h"

namespace control10k {

enum class ClassicalLaw { kComplexGradient, kContinuousGradient, kBalance, kLms, kBandPassPair };

inline constexpr int kMaxWindow = 256;

struct ClassicalConfig {
  ClassicalLaw law = ClassicalLaw::kLms;
  double period_s = 1e-4;
  int notches = 2;
  double radius = 0.995, initial_Hz = 1500.0;
  double mu = 5e-10;                             // of the first four, in the unit of the law
  double lowest_Hz = 50.0, highest_Hz = 4500.0;  // nu_0 stays within
  double increment_Hz = 0.5;                     // Delta of (5.13)
  double damping = 0.1;                          // of LP, BP and N, and of the pair
  double spread = 1.1;                           // nu_h / nu_0 = nu_0 / nu_l of the pair
  int window = 128;                              // M + 1
};

bool IsUsable(const ClassicalConfig& config);

/// A state-variable filter: low-pass, band-pass and what they leave, with the poles of nu^2 + 2 d nu s + s^2.
struct StateVariable {
  double s1 = 0.0, s2 = 0.0;
  /// g = tan(nu T_d / 2).
  void Step(double u, double g, double damping, double& low, double& band) {
    const double a = 1.0 / (1.0 + g * (g + 2.0 * damping));
    band = a * (s1 + g * (u - s2));
    low = s2 + g * band;
    s1 = 2.0 * band - s1;
    s2 = 2.0 * low - s2;
  }
};

struct ClassicalNotch {
  double nu_0 = 0.0;
  double u1 = 0.0, u2 = 0.0, y1 = 0.0, y2 = 0.0;  // of the notch
  double beta1 = 0.0, beta2 = 0.0;                // of the LMS gradient
  double z_re = 0.0, z_im = 0.0;                  // of the complex notch
  StateVariable low, high;
  double power = 0.0, low_level = 0.0, band_level = 0.0;
  double squares[kMaxWindow] = {};  // y_h^2 - y_l^2
  double sum = 0.0, place = 0.0;
};

struct ClassicalState {
  ClassicalNotch notch[kMaxNotches];
};

class Classical {
 public:
  explicit Classical(const ClassicalConfig& config) : config_(config) {}
  void Start(ClassicalState& state) const;
  /// Returns the filtered sample; nu_0 moves when `adapt`.
  double Step(ClassicalState& state, double T_shaft_Nm, bool adapt) const;
  const ClassicalConfig& config() const { return config_; }

 private:
  double Change(ClassicalNotch& notch, double u, double y) const;

  ClassicalConfig config_;
};

}  // namespace control10k
