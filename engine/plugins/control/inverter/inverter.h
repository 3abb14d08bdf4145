// Control `inverter`: what the dead time of an inverter's legs takes from the voltage that a control asks for, in the mean
// over a switching period.
//
// Between the two switches of a leg both are off for t_d, and the phase current alone decides to which rail the leg lies: a
// phase with a positive current misses the part t_d/T of the DC link's voltage, one with a negative current has it too
// much. Of the three errors the part that all phases have in common drives no current; as a space vector
//   u_out = u - (t_d/T) u_dc (2/3) (s_U + s_V e^(j 2 pi/3) + s_W e^(j 4 pi/3)),   s = i/i_c limited to +-1.
// Inputs u_alpha, u_beta [V] wanted, i_alpha, i_beta [A] measured; outputs u_alpha, u_beta [V] of the same period.
#pragma once

#include "model/component.h"
#include "model/registry.h"

namespace dynoproof::controls {

class Inverter : public Component {
 public:
  struct Params {
    double dc_link_V = 0.0, dead_time_s = 0.0, switching_period_s = 1e-4, soft_current_A = 1.0;
    void Visit(auto& v) {
      v.Required("dc_link_V", dc_link_V, Positive("V"), "voltage of the DC link");
      v.Optional("dead_time_s", dead_time_s, NonNegative(), "both switches of a leg are off for this long; 0: none");
      v.Optional("switching_period_s", switching_period_s, Positive(), "in which each switch of a leg is on once");
      v.Optional("soft_current_A", soft_current_A, Positive("A"),
                 "below this current a leg swings too slowly to miss all of it");
    }
    void Check(Faults& faults) const {
      if (dead_time_s >= 0.5 * switching_period_s) faults.At("dead_time_s", "is at least half the switching period");
    }
  };
  static PluginInfo Info();
  explicit Inverter(const Params& params);
  void Output(const View&, std::span<double>) const override {}  // held from tick to tick
  bool FeedsThrough(int, int) const override { return true; }
  void Tick(const View& view, std::span<double> states, std::span<double> outputs) const override;

 private:
  double missing_, inverse_soft_;
};

}  // namespace dynoproof::controls
