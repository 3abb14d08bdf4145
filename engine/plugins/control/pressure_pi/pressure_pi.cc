#include "plugins/control/pressure_pi/pressure_pi.h"

#include <algorithm>

namespace dynoproof::controls {

PluginInfo PressurePi::Info() {
  return {"control",
          "pressure_pi",
          "PI with feed-forward and conditioning between two limits",
          "w = k_P e + k_F r + x_I, x_I+ = x_I + T (k_I e + k_I/(k_P + k_F) (w_limited - w))",
          "thesis (6.18), (6.33); the sign of the second term is the one that unwinds",
          {}};
}

void PressurePi::Params::Check(Faults& faults) const {
  if (!(largest_Pa > least_Pa)) faults.At("largest_Pa", "no room between the limits", "largest_Pa > least_Pa");
  if (!(k_P + k_F > 0.0) && anti_windup != "none") {
    faults.At("k_P", "conditioning divides by k_P + k_F = 0", "k_P > 0, k_F > 0 or anti_windup = \"none\"");
  }
}

PressurePi::PressurePi(const Params& params, double period_s)
    : p_(params), pi_{{params.k_P, params.k_I_per_s, params.k_F}, AntiWindupOf(params.anti_windup), period_s} {
  layout_.inputs = {{"reference", "Pa", "pressure that is wanted", 1e5}, {"pressure", "Pa", "pressure that is", 1e5}};
  layout_.outputs = {{"command", "Pa", "command within its limits", 1e5},
                     {"wanted", "Pa", "command without limits", 1e5}};
  layout_.states = {{"integral", "Pa", "integral part", 1e5}, {"begun", "1", "0 before the first tick", 1.0}};
}

std::unique_ptr<PressurePi> PressurePi::Create(const Params& params, const Value& table, BuildContext& context) {
  return std::unique_ptr<PressurePi>(new PressurePi(params, PeriodOf(table, context)));
}

double PressurePi::Integral(const View& view) const {
  return view.states[1] != 0.0 ? view.states[0] : pi_.Fitting(view.inputs[0], view.inputs[1], p_.initial_Pa);
}

void PressurePi::Output(const View& view, std::span<double> outputs) const {
  outputs[1] = pi_.Wanted(view.inputs[0], view.inputs[1], Integral(view));
  outputs[0] = std::clamp(outputs[1], p_.least_Pa, p_.largest_Pa);
}

void PressurePi::Tick(const View& view, std::span<double> states, std::span<double> outputs) const {
  const double integral = Integral(view);
  Output(view, outputs);
  states[0] = pi_.NextIntegral(view.inputs[0], view.inputs[1], integral, outputs[1], outputs[0]);
  states[1] = 1.0;
}

}  // namespace dynoproof::controls
