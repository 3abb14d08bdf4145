// Law `dahl`: friction with elastic pre-sliding.
//
// T = F,  dF/dt = sigma w (1 - F sgn(w) / F_c), one state F [N m] that starts at 0. For small motion a spring sigma,
// for long motion +-F_c. F^2 / (2 sigma) is stored, F^2 |w| / F_c is lost: no energy is made. F_c = 0 is no friction.
// The rate is a guard (the kink of the law), without a mode.
#pragma once

#include "model/registry.h"

namespace dynoproof::laws {

class Dahl : public Law {
 public:
  struct Params {
    double F_c_Nm = 0.0, sigma_Nm_per_rad = 1.0;
    void Visit(auto& v) {
      v.Required("F_c_Nm", F_c_Nm, NonNegative(), "friction torque F_c of long motion");
      v.Required("sigma_Nm_per_rad", sigma_Nm_per_rad, Positive(), "pre-sliding stiffness sigma");
    }
  };
  static PluginInfo Info();
  explicit Dahl(const Params& params);

  double Torque(const LawView& view) const override { return view.states[0]; }
  void Derivative(const LawView& view, std::span<double> rates) const override;
  void Guards(const LawView& view, std::span<double> values) const override { values[0] = view.rate; }

 private:
  double F_c_, sigma_;
};

}  // namespace dynoproof::laws
