// Law `dahl`: friction with elastic pre-sliding, through a gap if there is one.
//
// T = F(d) = sigma d beyond the gap, dd/dt = w - |w| F / F_c: without a gap dF/dt = sigma w (1 - F sgn(w) / F_c). One
// state, the stretch d [rad] that starts at 0. For small motion a spring sigma behind the half gap a (F = 0 for
// |d| < a), for long motion +-F_c. F^2 / (2 sigma) is stored, F^2 |w| / F_c is lost: no energy is made. F_c = 0 is no
// friction. Guards, without a mode: the rate and the ends of the gap (the kinks of the law).
#pragma once

#include "model/registry.h"

namespace dynoproof::laws {

class Dahl : public Law {
 public:
  struct Params {
    double F_c_Nm = 0.0, sigma_Nm_per_rad = 1.0, half_gap_rad = 0.0;
    void Visit(auto& v) {
      v.Required("F_c_Nm", F_c_Nm, NonNegative(), "friction torque F_c of long motion");
      v.Required("sigma_Nm_per_rad", sigma_Nm_per_rad, Positive(), "pre-sliding stiffness sigma");
      v.Optional("half_gap_rad", half_gap_rad, NonNegative(), "half of the play a in series");
    }
  };
  static PluginInfo Info();
  explicit Dahl(const Params& params);

  double Torque(const LawView& view) const override;
  void Derivative(const LawView& view, std::span<double> rates) const override;
  void Guards(const LawView& view, std::span<double> values) const override;

 private:
  double F_c_, sigma_, half_gap_;
};

}  // namespace dynoproof::laws
