// Gains and references of the pressure controllers, thesis chapter 6.
#pragma once

#include <cmath>

namespace dynoproof::mechanics {

/// A PI controller with feed-forward: w = k_P (r - y) + k_F r + integral of k_I (r - y).
struct PiGains {
  double k_P, k_I, k_F;
};

/// (6.21): a volume of capacity C = V/(R theta) [kg/Pa] under mass flow follows r as a first-order lag v_n/(s + v_n).
inline PiGains FirstOrderLagGains(double capacity_kg_per_Pa, double v_n_rad_per_s) {
  return {2.0 * capacity_kg_per_Pa * v_n_rad_per_s, capacity_kg_per_Pa * v_n_rad_per_s * v_n_rad_per_s,
          -capacity_kg_per_Pa * v_n_rad_per_s};
}

/// (6.13): p_s / p_ch - 1 at which a flap of that area lets pass what the engine pumps [-]. `swept` = lambda V_d omega
/// / (2 pi N_r) [m^3/s].
inline double PressureSurplus(double swept_m3_per_s, double area_m2, double R_theta) {
  const double root = swept_m3_per_s / (area_m2 * std::sqrt(2.0 * R_theta));
  return root * root;
}

}  // namespace dynoproof::mechanics
