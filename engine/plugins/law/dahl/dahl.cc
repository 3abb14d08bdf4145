#include "plugins/law/dahl/dahl.h"

#include <cmath>

namespace dynoproof::laws {

PluginInfo Dahl::Info() {
  return {"law",
          "dahl",
          "friction with elastic pre-sliding",
          "T = F, dF/dt = sigma w (1 - F sgn(w) / F_c)",
          "Dahl, A Solid Friction Model, 1968 (exponent 1)",
          {}};
}

Dahl::Dahl(const Params& params) : F_c_(params.F_c_Nm), sigma_(params.sigma_Nm_per_rad) {
  layout_.states = {{"F", "N m", "friction torque", F_c_ > 0.0 ? F_c_ : 1.0}};
  layout_.guards = 1;
}

void Dahl::Derivative(const LawView& view, std::span<double> rates) const {
  const double w = view.rate, F = view.states[0];
  rates[0] = F_c_ > 0.0 ? sigma_ * (w - std::abs(w) * F / F_c_) : 0.0;
}

}  // namespace dynoproof::laws
