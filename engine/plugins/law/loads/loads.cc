#include "plugins/law/loads/loads.h"

#include <cmath>

namespace dynoproof::laws {

PluginInfo Viscous::Info() { return {"law", "viscous", "friction that grows with speed", "T = b w", "definition", {}}; }

PluginInfo QuadraticDrag::Info() {
  return {"law", "quadratic_drag", "windage: drag with the square of the speed", "T = b2 w |w|", "definition", {}};
}

PluginInfo ConstantLoad::Info() { return {"law", "constant", "constant load", "T = T_0", "definition", {}}; }

PluginInfo Ripple::Info() {
  return {
      "law",        "ripple", "torque that repeats with the angle (cogging, gear mesh)", "T = -A sin(n phi + theta)",
      "definition", {}};
}

double QuadraticDrag::Torque(const LawView& view) const { return b2_ * view.rate * std::abs(view.rate); }

double Ripple::Torque(const LawView& view) const { return -p_.A_Nm * std::sin(p_.n * view.twist + p_.theta_rad); }

}  // namespace dynoproof::laws
