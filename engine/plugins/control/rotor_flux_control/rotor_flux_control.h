// Control `rotor_flux_control` of an induction machine: flux, currents, averaged PWM. The code is the core's
// (engine/control10k/torque_control.h); the plugin only carries.
#pragma once

#include "control10k/torque_control.h"
#include "model/component.h"
#include "model/registry.h"
#include "plugins/plant/induction_machine/rating.h"

namespace dynoproof::controls {

/// Torque control oriented to the rotor flux. Inputs: torque [N m] set point, i_alpha, i_beta [A], speed [rad/s].
/// Outputs: u_alpha, u_beta [V], computed one tick before they are given (time to compute); torque [N m], the
/// controller's own estimate; i_q_set [A]. What it does and how it is tuned: README.md.
class RotorFluxControl : public Component {
 public:
  struct Params : Rating {
    double current_bandwidth_Hz = 300.0, flux_bandwidth_Hz = 5.0, dc_link_V = 565.0, overload = 2.0;
    double initial_torque_Nm = 0.0;
    void Visit(auto& v) {
      Rating::Visit(v);
      v.Optional("current_bandwidth_Hz", current_bandwidth_Hz, Between(1.0, 2000.0, "Hz"),
                 "of the current controllers");
      v.Optional("flux_bandwidth_Hz", flux_bandwidth_Hz, Between(0.1, 100.0, "Hz"), "of the flux controller");
      v.Optional("dc_link_V", dc_link_V, Positive("V"), "voltage of the inverter's DC link");
      v.Optional("overload", overload, Between(1.0, 10.0), "largest over rated current");
      v.Optional("initial_torque_Nm", initial_torque_Nm, Any(), "torque of the machine at t = 0");
    }
    /// As the core takes them, for a control that ticks with this period.
    control10k::TorqueConfig Config(double period_s) const;
  };
  static PluginInfo Info();
  RotorFluxControl(const Params& params, const BuildContext& context);
  void Output(const View&, std::span<double>) const override {}  // held from tick to tick
  bool FeedsThrough(int in, int out) const override { return out >= 2 && in >= 0; }
  void Tick(const View& view, std::span<double> states, std::span<double> outputs) const override;

 private:
  control10k::TorqueControl control_;
};

}  // namespace dynoproof::controls
