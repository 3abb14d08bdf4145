// Control `encoder`: the speed that a drive takes from a rotary encoder, by the steps that it counts in a period.
//
// n = floor(angle N / (2 pi)),  speed = 2 pi (n - n_before) / (N period). Input angle [rad], output speed [rad/s]: a whole
// multiple of 2 pi/(N period), half a period late. The error of one period is taken back by the next: the sum of all speeds
// is the angle. Before the second tick the speed is `initial_speed_rad_per_s`.
#pragma once

#include "model/component.h"
#include "model/registry.h"

namespace dynoproof::controls {

class Encoder : public Component {
 public:
  struct Params {
    double steps_per_turn = 0.0, initial_speed_rad_per_s = 0.0;
    void Visit(auto& v) {
      v.Required("steps_per_turn", steps_per_turn, Between(4.0, 1e9, "1"), "N: what it tells apart in a turn");
      v.Optional("initial_speed_rad_per_s", initial_speed_rad_per_s, Any(), "speed before there are two counts");
    }
  };
  static PluginInfo Info();
  Encoder(const Params& params, const BuildContext& context);
  void Output(const View&, std::span<double>) const override {}  // held from tick to tick
  bool FeedsThrough(int, int) const override { return true; }
  void Tick(const View& view, std::span<double> states, std::span<double> outputs) const override;

 private:
  double steps_per_rad_, speed_per_step_, initial_speed_;
};

}  // namespace dynoproof::controls
