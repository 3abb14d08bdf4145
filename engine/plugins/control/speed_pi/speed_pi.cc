#include "plugins/control/speed_pi/speed_pi.h"

namespace dynoproof::controls {

PluginInfo SpeedPi::Info() {
  return {"control",
          "speed_pi",
          "PI speed controller with torque limit",
          "T = clamp(k_P e + s, +-limit), s+ = s + k_I period e unless that drives T into its limit",
          "thesis (2.3), Secs. 3.2.4, 4.2 (their controllers are not printed)",
          {}};
}

SpeedPi::SpeedPi(const Params& params, double period_s)
    : config_{params.k_P_Nms_per_rad, params.k_I_Nm_per_rad, params.limit_Nm},
      initial_torque_(params.initial_torque_Nm),
      period_s_(period_s) {
  layout_.inputs = {{"reference", "rad/s", "speed that is wanted", 100.0}, {"speed", "rad/s", "speed that is", 100.0}};
  layout_.outputs = {{"torque", "N m", "torque command; accelerates when positive", params.limit_Nm}};
  layout_.states = {{"integral", "N m", "integral part s", params.limit_Nm},
                    {"begun", "1", "0 before the first tick", 1.0}};
}

std::unique_ptr<SpeedPi> SpeedPi::Create(const Params& params, const Value& table, BuildContext& context) {
  const Value* period = table.Find("period_s");
  const bool own = period != nullptr && period->is_number() && period->number() > 0.0;
  return std::unique_ptr<SpeedPi>(new SpeedPi(params, own ? period->number() : context.period_s));
}

control10k::SpeedState SpeedPi::Memory(std::span<const double> states) const {
  return {states[1] == 0.0 ? initial_torque_ : states[0]};
}

void SpeedPi::Output(const View& view, std::span<double> outputs) const {
  control10k::SpeedState memory = Memory(view.states);
  outputs[0] = control10k::SpeedStep(config_, memory, period_s_, view.inputs[0], view.inputs[1], 0.0, 0.0);
}

void SpeedPi::Tick(const View& view, std::span<double> states, std::span<double> outputs) const {
  control10k::SpeedState memory = Memory(view.states);
  outputs[0] = control10k::SpeedStep(config_, memory, period_s_, view.inputs[0], view.inputs[1], 0.0, 0.0);
  states[0] = memory.integral_Nm;
  states[1] = 1.0;
}

}  // namespace dynoproof::controls
