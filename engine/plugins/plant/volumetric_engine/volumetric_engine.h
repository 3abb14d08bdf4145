// Part `volumetric_engine`: an engine as a volumetric pump, thesis (6.10): q = p/(R theta) lambda V_d omega/(2 pi N_r).
// Inputs pressure [Pa] at its intake, speed [rad/s]; output q [kg/s]. At or below a pressure of 0 it takes nothing.
#pragma once

#include "model/registry.h"

namespace dynoproof {

class VolumetricEngine : public Component {
 public:
  struct Params {
    double displacement_m3 = 0.0, volumetric_efficiency = 1.0, revolutions_per_cycle = 2.0, R_J_per_kg_K = 287.05,
           theta_K = 320.0;
    void Visit(auto& v) {
      v.Required("displacement_m3", displacement_m3, Positive(), "displaced volume V_d");
      v.Optional("volumetric_efficiency", volumetric_efficiency, Positive("1"), "lambda");
      v.Optional("revolutions_per_cycle", revolutions_per_cycle, Positive("1"), "N_r: 2 for four strokes");
      v.Optional("R_J_per_kg_K", R_J_per_kg_K, Positive(), "specific gas constant R");
      v.Optional("theta_K", theta_K, Positive(), "temperature theta at the intake");
    }
  };
  static PluginInfo Info();
  explicit VolumetricEngine(const Params& params);

  bool FeedsThrough(int, int) const override { return true; }
  void Output(const View& view, std::span<double> outputs) const override;

 private:
  double per_turn_;  // kg per Pa and rad
};

}  // namespace dynoproof
