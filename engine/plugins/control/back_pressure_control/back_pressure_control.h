// Control `back_pressure_control`: the pressure of the exhaust pipe by its two flaps. Thesis Sec. 6.1.2 says that two flaps
// control it and prints no more; this follows its charge air control, (6.14)-(6.21).
//
//   w = conditioned PI (6.18), gains (6.21) with C = V/(chi R theta): the flow that is to leave, -w
//   A = -w/(p/sqrt(R theta) Psi(p/p_amb)), within what both flaps give
//   A_3+ = A_3 + T/tau (A - A_4,middle - A_3): the large flap goes where the small one stands in the middle of its range
//   A_4 = A - A_3: the small flap does what is left at once
// Inputs reference, pressure [Pa]; outputs u_3, u_4 [%].
#pragma once

#include "plugins/control/pressure_pi/conditioned_pi.h"
#include "plugins/plant/charge_air/charge_air.h"

namespace dynoproof::controls {

class BackPressureControl : public Component {
 public:
  struct Params {
    double volume_m3 = 0.0, theta_K = 750.0, R_J_per_kg_K = 290.0, chi = 1.33, ambient_pressure_Pa = 101300.0,
           bandwidth_Hz = 1.0, middle_s = 5.0, initial_u_3_percent = 50.0, initial_u_4_percent = 50.0;
    std::vector<std::pair<std::string, FlapParams>> flap;
    void Visit(auto& v) {
      v.Required("volume_m3", volume_m3, Positive(), "volume of the pipe");
      v.Optional("theta_K", theta_K, Positive(), "usual temperature of the gas");
      v.Optional("R_J_per_kg_K", R_J_per_kg_K, Positive(), "its gas constant");
      v.Optional("chi", chi, Between(1.0, 1.67, "1"), "its heat capacity ratio");
      v.Optional("ambient_pressure_Pa", ambient_pressure_Pa, Positive(), "pressure behind the flaps");
      v.Optional("bandwidth_Hz", bandwidth_Hz, Positive(), "f_n, v_n = 2 pi f_n in (6.21)");
      v.Optional("middle_s", middle_s, Positive(), "time in which the large flap brings the small one to its middle");
      v.Optional("initial_u_3_percent", initial_u_3_percent, Between(0.0, 100.0), "large flap at t = 0");
      v.Optional("initial_u_4_percent", initial_u_4_percent, Between(0.0, 100.0), "small flap at t = 0");
      v.Required("flap", flap, Any(), "[control.NAME.flap.3] and 4, as in the plant");
    }
    void Check(Faults& faults) const;
  };
  static PluginInfo Info();
  static std::unique_ptr<BackPressureControl> Create(const Params& params, const Value& table, BuildContext& context);

  bool FeedsThrough(int, int) const override { return true; }
  void Output(const View& view, std::span<double> outputs) const override;
  void Tick(const View& view, std::span<double> states, std::span<double> outputs) const override;

 private:
  BackPressureControl(const Params& params, double period_s);

  Params p_;
  mechanics::FlapArea large_, small_;
  ConditionedPi pi_;
  double step_;  // share of its way that the large flap goes in a tick
};

}  // namespace dynoproof::controls
