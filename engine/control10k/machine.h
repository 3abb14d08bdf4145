// What the core has to know of an induction machine: the four numbers of its fundamental wave model (inverse-Gamma
// equivalent circuit, peak values, star connection) and its rated point.
#pragma once

namespace control10k {

struct MachineModel {
  double R_s = 0.0, R_R = 0.0;      // stator, rotor [ohm]
  double L_M = 0.0, L_sigma = 0.0;  // magnetising, leakage [H]
  double pole_pairs = 1.0;
  double rated_flux = 0.0, rated_i_d = 0.0, rated_i_q = 0.0, rated_peak_current = 0.0;  // [V s], [A]

  double rotor_rate() const { return R_R / L_M; }  // 1 / rotor time constant
  double TorquePerAmpere(double flux) const { return 1.5 * pole_pairs * flux; }
};

}  // namespace control10k
