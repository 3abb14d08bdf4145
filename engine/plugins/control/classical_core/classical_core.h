// Control `classical_core`: the speed control of `core_10k` with one of the classical adaptive notch filters of the
// thesis (Sec. 5.3, 5.4.1) in place of the proposed ones. The code is control10k/classical.h.
//
// Ports in: as core_10k. Out: T_ref, T_filtered [N m], notch_1_Hz ...
#pragma once

#include "control10k/classical.h"
#include "control10k/speed_control.h"
#include "model/registry.h"

namespace dynoproof::controls {

class ClassicalCore : public Component {
 public:
  struct Params {
    std::string law = "lms";
    control10k::SpeedConfig speed;
    control10k::ClassicalConfig filter;
    void Visit(auto& v) {
      v.Optional(
          "law", law,
          std::vector<std::string>{"complex_gradient", "continuous_gradient", "balance", "lms", "band_pass_pair"},
          "(5.4), (5.6), (5.7), (5.12) or (5.13)");
      v.Optional("k_P_Nms_per_rad", speed.k_P_Nms_per_rad, NonNegative(), "proportional gain of the speed control");
      v.Optional("k_I_Nm_per_rad", speed.k_I_Nm_per_rad, NonNegative(), "integral gain of the speed control");
      v.Optional("T_limit_Nm", speed.T_limit_Nm, Positive(), "largest torque that is asked of the machine");
      v.Optional("notches", filter.notches, Between(1, control10k::kMaxNotches), "number of filters in series");
      v.Optional("radius", filter.radius, Between(0.5, 0.99999, "1"), "pole radius r");
      v.Optional("initial_Hz", filter.initial_Hz, Positive(), "frequency of all filters at the start");
      v.Optional("mu", filter.mu, NonNegative("1"), "step size, in the unit of the law");
      v.Optional("lowest_Hz", filter.lowest_Hz, Positive(), "frequencies stay above");
      v.Optional("highest_Hz", filter.highest_Hz, Positive(), "frequencies stay below");
      v.Optional("increment_Hz", filter.increment_Hz, NonNegative(), "Delta of (5.13), per sample");
      v.Optional("damping", filter.damping, Positive("1"), "damping ratio of the auxiliary filters");
      v.Optional("spread", filter.spread, Between(1.001, 4.0, "1"), "band-pass frequency over nu_0, (5.13)");
      v.Optional("window", filter.window, Between(1, control10k::kMaxWindow), "samples M + 1 of (5.14)");
    }
    void Check(Faults& faults) const;
  };
  static PluginInfo Info();
  ClassicalCore(const Params& params, const BuildContext& context);

  void Output(const View& view, std::span<double> outputs) const override;
  void Tick(const View& view, std::span<double> states, std::span<double> outputs) const override;

 private:
  control10k::SpeedConfig speed_;
  control10k::Classical filter_;
};

}  // namespace dynoproof::controls
