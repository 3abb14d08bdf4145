// The closed part of a fired four-stroke cycle, from closing intake (1) to opening exhaust valves (4): what a
// single-cylinder engine would measure, replaced by an ideal cycle. Isentropic to the volume at which half of the fuel
// is burnt (2), all heat there at once (3), isentropic to the end.
//
//   p_2 = p_1 (V_1/V_2)^chi_0,  U_3 = U_2 + Q,  p_3 = (chi_1 - 1) U_3/V_2,  p_4 = p_3 (V_2/V_4)^chi_1
//   W = U_1 + Q - U_4 with U = p V/(chi - 1): the first law holds exactly
//   Q = (1 - wall share) m_fuel H_u
// Index 0: compressed mixture, 1: exhaust gas. Later burning has a larger V_2: less work, hotter exhaust.
#pragma once

namespace dynoproof::mechanics {

struct FiredCycle {
  double chi_compression = 1.39, chi_expansion = 1.33;
  double heating_value = 47e6;  // H_u [J/kg]
  double wall_share = 0.0;      // 0 ... 1

  struct Result {
    double pressure_end, pressure_fired;  // p_4, p_3 [Pa]
    double work;                          // W [J], absolute pressures
    double heat;                          // Q [J]
    double theta_unburnt;                 // [K]: charge compressed from theta_1, p_1 to p_3: what knocks
  };
  /// Pressures [Pa] and volumes [m^3] > 0, fuel [kg] >= 0, theta_1 [K].
  Result Run(double p_1, double theta_1, double v_1, double v_2, double v_4, double fuel) const;
};

}  // namespace dynoproof::mechanics
