#include "plugins/law/springs/springs.h"

namespace dynoproof::laws {

PluginInfo SpringDamperLaw::Info() {
  return {"law", "spring_damper", "linear torsional spring and damper", "T = k d + c w", "thesis Sec. 2.2.1, (2.8)",
          {}};
}

PluginInfo CubicSpring::Info() {
  return {"law",
          "cubic_spring",
          "spring with a cubic part, and damper",
          "T = k d + k3 d^3 + c w",
          "Duffing oscillator, restoring torque",
          {}};
}

PluginInfo WarmingSpring::Info() {
  return {"law",
          "warming_spring",
          "spring that loses stiffness as it warms up, and damper",
          "T = k (1 - loss (1 - exp(-t / loss_time))) d + c w",
          "thesis Sec. 5.2 (category 2: parameters that change with temperature); exponential warming",
          {}};
}

void SpringDamperLaw::Params::Check(Faults& faults) const {
  if (stiffness_Nm_per_rad == 0.0 && damping_Nms_per_rad == 0.0) {
    faults.At("stiffness_Nm_per_rad", "stiffness and damping are both 0: nothing connects", "at least one > 0");
  }
}

}  // namespace dynoproof::laws
