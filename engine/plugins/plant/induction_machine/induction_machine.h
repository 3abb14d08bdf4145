// An induction machine as fundamental wave model (thesis Secs. 2.1, 3.1).
//
// Inputs: u_alpha, u_beta [V] phase voltage in the stator's frame (mean over a switching period), speed [rad/s] of the
// shaft. Outputs: torque [N m] of the air gap, i_alpha, i_beta [A], flux [V s] magnitude of the rotor flux.
// States: stator current and rotor flux in the stator's frame.
#pragma once

#include "model/component.h"
#include "model/registry.h"
#include "plugins/plant/induction_machine/rating.h"

namespace dynoproof {

class InductionMachine : public Component {
 public:
  struct Params : Rating {
    double initial_torque_Nm = 0.0;
    void Visit(auto& v) {
      Rating::Visit(v);
      v.Optional("initial_torque_Nm", initial_torque_Nm, Any(), "torque at t = 0, with rated flux");
    }
  };
  static PluginInfo Info();
  explicit InductionMachine(const Params& params);

  void Start(std::span<const double> inputs, std::span<double> states, std::span<int> modes) const override;
  void Output(const View& view, std::span<double> outputs) const override;
  void Derivative(const View& view, std::span<double> rates) const override;

 private:
  MachineModel m_;
  double initial_torque_, inverse_leakage_, rotor_rate_, damping_, transfer_;
};

}  // namespace dynoproof
