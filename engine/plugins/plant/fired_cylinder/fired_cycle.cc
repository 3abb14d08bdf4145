#include "plugins/plant/fired_cylinder/fired_cycle.h"

#include <cmath>

namespace dynoproof::mechanics {

FiredCycle::Result FiredCycle::Run(double p_1, double theta_1, double v_1, double v_2, double v_4, double fuel) const {
  const double p_2 = p_1 * std::pow(v_1 / v_2, chi_compression);
  const double heat = (1.0 - wall_share) * fuel * heating_value;
  const double u_1 = p_1 * v_1 / (chi_compression - 1.0), u_3 = p_2 * v_2 / (chi_compression - 1.0) + heat;
  const double p_3 = (chi_expansion - 1.0) * u_3 / v_2, p_4 = p_3 * std::pow(v_2 / v_4, chi_expansion);
  const double u_4 = p_4 * v_4 / (chi_expansion - 1.0);
  return {p_4, p_3, u_1 + heat - u_4, heat, theta_1 * std::pow(p_3 / p_1, (chi_compression - 1.0) / chi_compression)};
}

}  // namespace dynoproof::mechanics
