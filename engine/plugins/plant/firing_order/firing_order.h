// Part `firing_order`: torque of an engine whose cylinders fire one behind the other, in place of the work that
// `power_train` spreads over a cycle. thesis (6.2) has an indicated torque; how it pulsates is not printed.
//
//   closed strokes of a cylinder, phi from closing intake (1) to opening exhaust valves (4), dead centre at 2 pi (c):
//   p = p_1 (V_1/V)^n_c before, p_3 (V_c/V)^n_e behind it      T = (p - p_crankcase) A s'(phi)
//   W = -p_1 V_1/(n_c - 1) ((V_1/V_c)^(n_c - 1) - 1) + p_3 V_c/(n_e - 1) (1 - (V_c/V_4)^(n_e - 1)) - p_crankcase (V_4 - V_1)
//
// The last line gives p_3, so that a cycle does the work W that was measured, whatever its course. Cylinders of a bank are
// evenly spaced, each bank is `bank_offset_deg` behind the one before it. As in engine_bank, valves are noticed as an
// interval of the run ends (guard -1), so that both hand the piston over at the same tick.
//
// Inputs angle [rad], work W [J], pressure p_1 [Pa] as the intake closed, open_torque [N m] of the gas while valves are
// open; outputs torque [N m] of all, closed_torque of the closed strokes alone.
#pragma once

#include "model/registry.h"
#include "plugins/physics/cylinder_geometry.h"

namespace dynoproof {

class FiringOrder : public Component {
 public:
  struct Params {
    CylinderGeometry geometry;
    int cylinders = 10, banks = 2;
    double bank_offset_deg = 0.0, intake_closes_deg = 0.0, exhaust_opens_deg = 0.0, exponent_compression = 1.37,
           exponent_expansion = 1.33, crankcase_pressure_Pa = 101300.0;
    void Visit(auto& v) {
      geometry.Visit(v);
      v.Optional("cylinders", cylinders, Between(1, 12), "of a bank, evenly spaced");
      v.Optional("banks", banks, Between(1, 4), "of the engine");
      v.Optional("bank_offset_deg", bank_offset_deg, Between(-360.0, 360.0, "deg"),
                 "by which a bank fires behind the one before it");
      v.Required("intake_closes_deg", intake_closes_deg, Between(0.0, 360.0, "deg"), "as in the bank");
      v.Required("exhaust_opens_deg", exhaust_opens_deg, Between(360.0, 720.0, "deg"), "as in the bank");
      v.Optional("exponent_compression", exponent_compression, Between(1.01, 1.67), "n_c");
      v.Optional("exponent_expansion", exponent_expansion, Between(1.01, 1.67), "n_e");
      v.Optional("crankcase_pressure_Pa", crankcase_pressure_Pa, NonNegative(), "pressure underneath the piston");
    }
    void Check(Faults& faults) const { geometry.Check(faults); }
  };
  enum Input_ { kAngle, kWork, kPressure, kOpenTorque };
  enum Output_ { kTorque, kClosedTorque };
  static PluginInfo Info();
  explicit FiringOrder(const Params& params);

  bool FeedsThrough(int in, int out) const override { return in != kOpenTorque || out == kTorque; }
  void Start(std::span<const double> inputs, std::span<double> states, std::span<int> modes) const override;
  void Output(const View& view, std::span<double> outputs) const override;
  void OnEvent(const View& view, int guard, std::span<double> states, std::span<int> modes) const override;

 private:
  /// Cycles that each cylinder has begun with its open exhaust, then with its closed intake.
  void Count(double angle, std::span<int> modes) const;

  struct Offset {
    double phi, sine, cosine;
  };
  Params p_;
  mechanics::SliderCrank crank_;
  double piston_area_, clearance_, volume_1_, volume_4_, opens_, closes_;
  std::vector<Offset> offset_;  // of the cylinders to the first
};

}  // namespace dynoproof
