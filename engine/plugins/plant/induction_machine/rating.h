// From the rated data on a machine's plate to the four numbers of its fundamental wave model. Derivation: README.md.
#pragma once

#include <cmath>

#include "control10k/machine.h"
#include "model/params.h"

namespace dynoproof {

using control10k::MachineModel;

/// What a plate says, and what it does not.
struct Rating {
  double rated_torque_Nm = 0.0, rated_speed_rad_per_s = 0.0, rated_voltage_V = 0.0, rated_current_A = 0.0;
  int pole_pairs = 2;
  double slip = 0.06, efficiency = 0.82, magnetising_share = 0.456;

  void Visit(auto& v) {
    v.Required("rated_torque_Nm", rated_torque_Nm, Positive(), "rated torque");
    v.Required("rated_speed_rad_per_s", rated_speed_rad_per_s, Positive(), "rated speed");
    v.Required("rated_voltage_V", rated_voltage_V, Positive("V"), "rated line-to-line voltage, RMS");
    v.Required("rated_current_A", rated_current_A, Positive("A"), "rated current, RMS");
    v.Optional("pole_pairs", pole_pairs, Between(1, 20), "number of pole pairs");
    v.Optional("slip", slip, Between(1e-3, 0.2), "rated slip, usually not on the plate");
    v.Optional("efficiency", efficiency, Between(0.3, 0.999), "rated efficiency without iron and windage losses");
    v.Optional("magnetising_share", magnetising_share, Between(0.1, 0.9), "rated flux-forming over whole current");
  }
  /// The parameters behind the rated point; false when no machine has such a plate.
  bool Derive(MachineModel& model) const {
    const double current = std::sqrt(2.0) * rated_current_A, voltage = std::sqrt(2.0 / 3.0) * rated_voltage_V;
    const double nu = pole_pairs * rated_speed_rad_per_s / (1.0 - slip);  // of the voltage
    const double i_d = magnetising_share * current, i_q = std::sqrt(current * current - i_d * i_d);
    model.pole_pairs = pole_pairs;
    model.rated_peak_current = current;
    model.rated_i_d = i_d;
    model.rated_i_q = i_q;
    model.L_M = rated_torque_Nm / (1.5 * pole_pairs * i_d * i_q);
    model.rated_flux = model.L_M * i_d;
    model.R_R = slip * nu * model.L_M * i_d / i_q;
    const double air_gap_power = nu / pole_pairs * rated_torque_Nm;
    const double power = rated_torque_Nm * rated_speed_rad_per_s / efficiency;
    model.R_s = (power - air_gap_power) / (1.5 * current * current);
    // voltage^2 = (R_s i_d - nu L i_q)^2 + (R_s i_q + nu (L + L_M) i_d)^2, solved for the leakage L.
    const double a = nu * nu * current * current, b = nu * nu * model.L_M * i_d * i_d;
    const double r = model.R_s * i_q + nu * model.L_M * i_d;
    const double c = r * r + model.R_s * model.R_s * i_d * i_d - voltage * voltage;
    if (!(model.R_s > 0.0) || b * b - a * c < 0.0) return false;
    model.L_sigma = (-b + std::sqrt(b * b - a * c)) / a;
    return model.L_sigma > 0.0;
  }
  void Check(Faults& faults) const {
    MachineModel model;
    if (Derive(model)) return;
    faults.At("rated_voltage_V",
              "no machine has these rated data: they leave no positive stator resistance and leakage",
              "lower efficiency or magnetising_share, or check voltage and current");
  }
};

}  // namespace dynoproof
