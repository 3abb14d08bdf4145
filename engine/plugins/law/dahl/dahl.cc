#include "plugins/law/dahl/dahl.h"

#include <algorithm>
#include <cmath>

namespace dynoproof::laws {

PluginInfo Dahl::Info() {
  return {"law",
          "dahl",
          "friction with elastic pre-sliding",
          "T = F = sigma d beyond the half gap, dd/dt = w - abs(w) F / F_c",
          "Dahl, A Solid Friction Model, 1968 (exponent 1)",
          {}};
}

Dahl::Dahl(const Params& params)
    : F_c_(params.F_c_Nm), sigma_(params.sigma_Nm_per_rad), half_gap_(params.half_gap_rad) {
  layout_.states = {{"d", "rad", "stretch before the slip", F_c_ > 0.0 ? half_gap_ + F_c_ / sigma_ : 1.0}};
  layout_.guards = half_gap_ > 0.0 ? 3 : 1;
}

double Dahl::Torque(const LawView& view) const {
  const double d = view.states[0];
  return sigma_ * (std::max(0.0, d - half_gap_) + std::min(0.0, d + half_gap_));
}

void Dahl::Derivative(const LawView& view, std::span<double> rates) const {
  const double w = view.rate;
  rates[0] = F_c_ > 0.0 ? w - std::abs(w) * Torque(view) / F_c_ : 0.0;
}

void Dahl::Guards(const LawView& view, std::span<double> values) const {
  values[0] = view.rate;
  if (half_gap_ == 0.0) return;
  values[1] = view.states[0] - half_gap_;
  values[2] = view.states[0] + half_gap_;
}

}  // namespace dynoproof::laws
