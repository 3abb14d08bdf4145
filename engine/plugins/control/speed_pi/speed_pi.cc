#include "plugins/control/speed_pi/speed_pi.h"

#include <algorithm>

namespace dynoproof::controls {

PluginInfo SpeedPi::Info() {
  return {"control",
          "speed_pi",
          "PI speed controller with torque limit",
          "T = clamp(k_P e + s, +-limit), s+ = s + k_I period e unless that drives T into its limit",
          "thesis Sec. 4.2 (speed ramp of the dynamometer; its controller is not printed)",
          {}};
}

SpeedPi::SpeedPi(const Params& params, double period_s) : p_(params), period_s_(period_s) {
  layout_.inputs = {{"reference", "rad/s", "speed that is wanted", 100.0}, {"speed", "rad/s", "speed that is", 100.0}};
  layout_.outputs = {{"torque", "N m", "torque command; accelerates when positive", p_.limit_Nm}};
  layout_.states = {{"integral", "N m", "integral part s", p_.limit_Nm}};
}

std::unique_ptr<SpeedPi> SpeedPi::Create(const Params& params, const Value& table, BuildContext& context) {
  const Value* period = table.Find("period_s");
  const bool own = period != nullptr && period->is_number() && period->number() > 0.0;
  return std::unique_ptr<SpeedPi>(new SpeedPi(params, own ? period->number() : context.period_s));
}

void SpeedPi::Output(const View& view, std::span<double> outputs) const {
  const double e = view.inputs[0] - view.inputs[1];
  outputs[0] = std::clamp(p_.k_P_Nms_per_rad * e + view.states[0], -p_.limit_Nm, p_.limit_Nm);
}

void SpeedPi::Tick(const View& view, std::span<double> states, std::span<double> outputs) const {
  Output(view, outputs);
  const double e = view.inputs[0] - view.inputs[1];
  const bool further = (outputs[0] >= p_.limit_Nm && e > 0.0) || (outputs[0] <= -p_.limit_Nm && e < 0.0);
  if (!further) states[0] += p_.k_I_Nm_per_rad * period_s_ * e;
}

}  // namespace dynoproof::controls
