// Part `single_cylinder`: the torque of a four-stroke single-cylinder engine on its crankshaft, resolved over the crank
// angle: gas, oscillating masses, friction.
//
// phi = angle + start angle, top dead centre with gas exchange at 0; piston travel s = r (1 - cos phi) + L
// - sqrt(L^2 - r^2 sin^2 phi), chamber volume V = V_c + A s.
//   0 ... pi      intake       p = p_in
//   pi ... 2 pi   compression  p = p_in (V_bottom / V)^n_c
//   2 pi ... 3 pi expansion    p = lambda p_in eps^n_c (V_c / V)^n_e     (lambda = 1: motored; else fired at top dead
//   centre) 3 pi ... 4 pi exhaust      p = p_ex
// T = (p - p_crankcase) A s' - m s' s'' w^2 - (T_f + b |w|) tanh(w / w_0),  ' = d/d phi.
// Pressure jumps only where s' = 0: the torque is continuous. The share m s'^2 dw/dt of the oscillating masses is left
// out: it belongs to the inertia of the crankshaft, whose mean the line has already.
#pragma once

#include "model/registry.h"
#include "plugins/physics/slider_crank.h"

namespace dynoproof {

class SingleCylinder : public Component {
 public:
  struct Params {
    double bore_m = 0.0, stroke_m = 0.0, rod_m = 0.0, compression_ratio = 0.0, intake_pressure_Pa = 101300.0,
           exhaust_pressure_Pa = 101300.0, crankcase_pressure_Pa = 101300.0, exponent_compression = 1.35,
           exponent_expansion = 1.35, firing_pressure_ratio = 1.0, oscillating_mass_kg = 0.0, friction_Nm = 0.0,
           friction_Nms_per_rad = 0.0, friction_speed_rad_per_s = 1.0, start_angle_rad = 0.0;
    void Visit(auto& v) {
      v.Required("bore_m", bore_m, Positive(), "bore");
      v.Required("stroke_m", stroke_m, Positive(), "stroke 2 r");
      v.Required("rod_m", rod_m, Positive(), "length L of the connecting rod");
      v.Required("compression_ratio", compression_ratio, Between(1.1, 50.0), "compression ratio eps");
      v.Optional("intake_pressure_Pa", intake_pressure_Pa, Positive(), "pressure p_in during intake");
      v.Optional("exhaust_pressure_Pa", exhaust_pressure_Pa, Positive(), "pressure p_ex during exhaust");
      v.Optional("crankcase_pressure_Pa", crankcase_pressure_Pa, NonNegative(), "pressure underneath the piston");
      v.Optional("exponent_compression", exponent_compression, Between(1.0, 1.7), "polytropic exponent n_c");
      v.Optional("exponent_expansion", exponent_expansion, Between(1.0, 1.7), "polytropic exponent n_e");
      v.Optional("firing_pressure_ratio", firing_pressure_ratio, Between(1.0, 20.0),
                 "pressure behind over pressure before firing, at top dead centre; 1: motored");
      v.Optional("oscillating_mass_kg", oscillating_mass_kg, NonNegative(), "oscillating mass m");
      v.Optional("friction_Nm", friction_Nm, NonNegative(), "dry friction T_f");
      v.Optional("friction_Nms_per_rad", friction_Nms_per_rad, NonNegative(), "viscous friction b");
      v.Optional("friction_speed_rad_per_s", friction_speed_rad_per_s, Positive(),
                 "speed w_0 below which the dry friction goes to 0");
      v.Optional("start_angle_rad", start_angle_rad, Any(), "crank angle at t = 0");
    }
    void Check(Faults& faults) const;
  };
  static PluginInfo Info();
  explicit SingleCylinder(const Params& params);

  bool FeedsThrough(int, int) const override { return true; }
  void Output(const View& view, std::span<double> outputs) const override;

 private:
  /// Travel s and its first two derivatives by the crank angle.
  double Pressure(double phi, double s) const;

  Params p_;
  mechanics::SliderCrank crank_;
  double area_, clearance_;  // A, V_c
};

}  // namespace dynoproof
