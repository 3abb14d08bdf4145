// Part `fired_cylinder`: stands in for the single-cylinder engine of the test bed: what it would measure of the closed
// part of its cycle for the charge that the model of the full engine trapped. mechanics/fired_cycle.h has the cycle.
// Synthetic: in a hardware-in-the-loop run these are measurements.
//
//   work = W - p_crankcase (V_4 - V_1)     lambda = m_air/(L m_fuel)     retard of the ignition moves the place of the
//   heat release knock = exp((theta_u - theta_knock)/theta_scale)   NOx/limit = exp(-a (lambda - lambda_0) - b retard)
//
// Inputs air [kg], theta [K], pressure [Pa], fuel [kg] as trapped, retard [deg]; outputs p_evo, work, peak_pressure,
// air_ratio, knock, nox. No states.
#pragma once

#include "model/registry.h"
#include "plugins/plant/engine_bank/geometry.h"
#include "plugins/plant/fired_cylinder/fired_cycle.h"

namespace dynoproof {

class FiredCylinder : public Component {
 public:
  struct Params {
    CylinderGeometry geometry;
    double intake_closes_deg = 0.0, exhaust_opens_deg = 0.0, chi_compression = 1.37, chi_expansion = 1.33,
           heating_value_J_per_kg = 47e6, wall_share = 0.15, air_need = 16.8, heat_at_deg = 10.0, knock_theta_K = 800.0,
           knock_scale_K = 25.0, nox_air_ratio = 1.8, nox_per_air_ratio = 12.0, nox_per_deg = 0.1,
           crankcase_pressure_Pa = 101300.0;
    void Visit(auto& v) {
      geometry.Visit(v);
      v.Required("intake_closes_deg", intake_closes_deg, Between(-360.0, 1080.0, "deg"), "as in the bank");
      v.Required("exhaust_opens_deg", exhaust_opens_deg, Between(-360.0, 720.0, "deg"), "as in the bank");
      v.Optional("chi_compression", chi_compression, Between(1.01, 1.67), "of the mixture");
      v.Optional("chi_expansion", chi_expansion, Between(1.01, 1.67), "of the exhaust gas, as in the bank");
      v.Optional("heating_value_J_per_kg", heating_value_J_per_kg, Positive(), "lower heating value H_u");
      v.Optional("wall_share", wall_share, Between(0.0, 1.0), "of the heat that goes to the walls");
      v.Optional("air_need", air_need, Positive("1"), "stoichiometric air, kg per kg of fuel");
      v.Optional("heat_at_deg", heat_at_deg, Between(0.0, 90.0, "deg"), "place of the heat release without retard");
      v.Optional("knock_theta_K", knock_theta_K, Positive(), "end gas that is just about to knock");
      v.Optional("knock_scale_K", knock_scale_K, Positive(), "by which knock grows e-fold");
      v.Optional("nox_air_ratio", nox_air_ratio, Positive("1"), "air ratio with NOx at its limit, without retard");
      v.Optional("nox_per_air_ratio", nox_per_air_ratio, NonNegative("1"), "its fall over the air ratio, logarithmic");
      v.Optional("nox_per_deg", nox_per_deg, NonNegative("1"), "its fall over the retard, logarithmic");
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
