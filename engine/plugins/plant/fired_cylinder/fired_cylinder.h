// Part `fired_cylinder`: stands in for the single-cylinder engine of the test bed: what it would measure of the closed
// part of its cycle for the charge that the model of the full engine trapped. mechanics/fired_cycle.h has the cycle.
// Synthetic: in a hardware-in-the-loop run these are measurements.
//
//   work = W - p_crankcase (V_4 - V_1)     retard of the ignition moves the place of the heat release
// Air ratio, knock and NOx: cycle_indices.h.
//
// Inputs air [kg], theta [K], pressure [Pa], fuel [kg] as trapped, retard [deg]; outputs p_evo, work, peak_pressure,
// air_ratio, knock, nox. No states.
#pragma once

#include "model/registry.h"
#include "plugins/physics/cylinder_geometry.h"
#include "plugins/plant/fired_cylinder/cycle_indices.h"
#include "plugins/plant/fired_cylinder/fired_cycle.h"

namespace dynoproof {

class FiredCylinder : public Component {
 public:
  struct Params {
    CylinderGeometry geometry;
    double intake_closes_deg = 0.0, exhaust_opens_deg = 0.0, chi_compression = 1.37, chi_expansion = 1.33,
           heating_value_J_per_kg = 47e6, wall_share = 0.15, heat_at_deg = 10.0, crankcase_pressure_Pa = 101300.0;
    CycleIndices indices;
    void Visit(auto& v) {
      geometry.Visit(v);
      v.Required("intake_closes_deg", intake_closes_deg, Between(-360.0, 1080.0, "deg"), "as in the bank");
      v.Required("exhaust_opens_deg", exhaust_opens_deg, Between(-360.0, 720.0, "deg"), "as in the bank");
      v.Optional("chi_compression", chi_compression, Between(1.01, 1.67), "of the mixture");
      v.Optional("chi_expansion", chi_expansion, Between(1.01, 1.67), "of the exhaust gas, as in the bank");
      v.Optional("heating_value_J_per_kg", heating_value_J_per_kg, Positive(), "lower heating value H_u");
      v.Optional("wall_share", wall_share, Between(0.0, 1.0), "of the heat that goes to the walls");
      v.Optional("heat_at_deg", heat_at_deg, Between(0.0, 90.0, "deg"), "place of the heat release without retard");
      indices.Visit(v);
      v.Optional("crankcase_pressure_Pa", crankcase_pressure_Pa, NonNegative(), "pressure underneath the piston");
    }
    void Check(Faults& faults) const;
  };
  static PluginInfo Info();
  explicit FiredCylinder(const Params& params);

  bool FeedsThrough(int, int) const override { return true; }
  void Output(const View& view, std::span<double> outputs) const override;

 private:
  Params p_;
  mechanics::FiredCycle cycle_;
  double volume_closed_, volume_open_;
};

}  // namespace dynoproof
