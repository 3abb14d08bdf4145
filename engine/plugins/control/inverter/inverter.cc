#include "plugins/control/inverter/inverter.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace dynoproof::controls {

PluginInfo Inverter::Info() {
  return {"control",
          "inverter",
          "dead time of an inverter in the mean over a switching period",
          "u - (t_d/T) u_dc (2/3) (s_U + s_V e^(j 2 pi/3) + s_W e^(j 4 pi/3)), s = i/i_c within +-1",
          "thesis Secs. 2, 2.1.1 (names inverter and PWM); mean value model: README",
          {}};
}

Inverter::Inverter(const Params& params)
    : missing_(params.dead_time_s / params.switching_period_s * params.dc_link_V),
      inverse_soft_(1.0 / params.soft_current_A) {
  const double volts = params.dc_link_V / std::sqrt(3.0);
  layout_.inputs = {{"u_alpha", "V", "voltage that is wanted, real part", volts},
                    {"u_beta", "V", "voltage that is wanted, imaginary part", volts},
                    {"i_alpha", "A", "current of the load, real part", 100.0},
                    {"i_beta", "A", "current of the load, imaginary part", 100.0}};
  layout_.outputs = {{"u_alpha", "V", "mean voltage of the coming period, real part", volts},
                     {"u_beta", "V", "mean voltage of the coming period, imaginary part", volts}};
}

void Inverter::Tick(const View& view, std::span<double>, std::span<double> outputs) const {
  const double i_alpha = view.inputs[2], i_beta = view.inputs[3];
  const auto sign = [this](double current) { return std::clamp(inverse_soft_ * current, -1.0, 1.0); };
  const double half_root_3 = 0.5 * std::numbers::sqrt3;
  const double U = sign(i_alpha), V = sign(-0.5 * i_alpha + half_root_3 * i_beta),
               W = sign(-0.5 * i_alpha - half_root_3 * i_beta);
  outputs[0] = view.inputs[0] - missing_ * (2.0 * U - V - W) / 3.0;
  outputs[1] = view.inputs[1] - missing_ * (V - W) / std::numbers::sqrt3;
}

}  // namespace dynoproof::controls
