// Control `core_10k`: the 10 kHz core (engine/control10k) in a scenario. The plugin only carries: parameters into the
// core's configuration, ports into its inputs, the frame into its state and back. Every scenario runs exactly that
// code.
//
// Ports in: T_shaft [N m], omega, omega_ref [rad/s], k_V [1], adapt [1, on above 0.5]. Out: T_ref, T_filtered [N m],
// notch_1_Hz .., eta_1 .. [N m] (in the order of the filters), placements, outcome [1], found_Hz, found_Nm.
#pragma once

#include "control10k/core.h"
#include "model/registry.h"

namespace dynoproof::controls {

class Core10k : public Component {
 public:
  struct Params {
    control10k::CoreConfig core;
    void Visit(auto& v) {
      auto& speed = core.speed;
      auto& c = core.suppression;
      v.Optional("k_P_Nms_per_rad", speed.k_P_Nms_per_rad, NonNegative(), "proportional gain of the speed control");
      v.Optional("k_I_Nm_per_rad", speed.k_I_Nm_per_rad, NonNegative(), "integral gain of the speed control");
      v.Optional("T_limit_Nm", speed.T_limit_Nm, Positive(), "largest torque that is asked of the machine");
      v.Optional("notches", c.notches, Between(1, control10k::kMaxNotches - 1), "number N_f of notch filters");
      v.Optional("radius", c.radius, Between(0.5, 1.0, "1"), "pole radius r of a placed filter");
      v.Optional("initial_Hz", c.initial_Hz, Positive(), "frequency of filters that are not in use yet");
      v.Optional("block", c.block, Between(4, control10k::kMaxBlock), "samples N of a Goertzel block");
      v.Optional("bins", c.bins, Between(3, control10k::kMaxBins), "bins N_g, from the first on");
      v.Optional("T_min_Nm", c.T_min_Nm, NonNegative(), "condition 1: smallest amplitude, (5.31)");
      v.Optional("f_min_Hz", c.f_min_Hz, Positive(), "condition 2: lowest frequency, (5.34)");
      v.Optional("f_max_Hz", c.f_max_Hz, Positive(), "condition 2: highest frequency, (5.34)");
      v.Optional("low_edge", c.low_edge, Between(1, 16),
                 "condition 2: bins from the first that must not be the largest");
      v.Optional("high_edge", c.high_edge, Between(1, 16), "condition 2: the same from the last");
      v.Optional("lobe_tolerance", c.lobe_tolerance, Positive("1"), "condition 3: nearer neighbour, (5.35)");
      v.Optional("far_lobe_tolerance", c.far_lobe_tolerance, Positive("1"),
                 "condition 3: neighbour further away, where (5.28) itself misses a clean tone by 5.7 %");
      v.Optional("steady", c.steady, Between(1, control10k::kMaxSteady - 1), "condition 4: differences N_s, (5.36)");
      v.Optional("epsilon_Hz", c.epsilon_Hz, Positive(), "condition 4: limit of their sum");
      v.Optional("alpha", c.alpha, Between(0.0, 1.0, "1"), "decay of a stored amplitude per sample, (5.37)");
      v.Optional("zeta", c.zeta, Between(1.0, 100.0, "1"), "floor of a stored amplitude over T_min");
      v.Optional("probe_gamma", c.probe_gamma, Between(0.0, 0.5, "1"),
                 "Appendix E: step of the pole radius; 0: frequencies are placed at once");
      v.Optional("probe_shift_Hz", c.probe_shift_Hz, NonNegative(), "Appendix E: reaction that counts as one");
      v.Optional("probe_patience", c.probe_patience, Between(1, 1000), "Appendix E: blocks to wait for it");
    }
    void Check(Faults& faults) const;
  };
  static PluginInfo Info();
  static std::unique_ptr<Core10k> Create(const Params& params, const Value& table, BuildContext& context);
  explicit Core10k(const control10k::CoreConfig& config);

  void Output(const View& view, std::span<double> outputs) const override;
  void Tick(const View& view, std::span<double> states, std::span<double> outputs) const override;

 private:
  void Report(const control10k::CoreState& state, std::span<double> outputs) const;

  control10k::Core core_;
};

}  // namespace dynoproof::controls
