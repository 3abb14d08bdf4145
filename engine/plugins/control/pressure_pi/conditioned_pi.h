// A sampled PI controller with feed-forward and conditioning, thesis (6.18), for pressures.
//
//   w = k_P (r - y) + k_F r + x_I         w^ = w within its limits
//   x_I+ = x_I + T (k_I (r - y) + k_I/(k_P + k_F) (w^ - w))
// The print has (w - w^) in the last term: the integrator would run away all the faster.
#pragma once

#include <string>
#include <vector>

#include "model/registry.h"
#include "plugins/control/pressure_pi/pressure_gains.h"

namespace dynoproof::controls {

enum class AntiWindup { kConditioned, kNone, kAsPrinted };

struct ConditionedPi {
  mechanics::PiGains gains;
  AntiWindup anti_windup = AntiWindup::kConditioned;
  double period_s = 1e-3;

  double Wanted(double reference, double value, double integral) const {
    return gains.k_P * (reference - value) + gains.k_F * reference + integral;
  }
  /// The integral with which the controller gives `output` now: a bumpless start.
  double Fitting(double reference, double value, double output) const { return output - Wanted(reference, value, 0.0); }
  double NextIntegral(double reference, double value, double integral, double wanted, double given) const {
    double conditioning = 0.0;
    if (anti_windup != AntiWindup::kNone) {
      const double excess = anti_windup == AntiWindup::kAsPrinted ? wanted - given : given - wanted;
      conditioning = gains.k_I / (gains.k_P + gains.k_F) * excess;
    }
    return integral + period_s * (gains.k_I * (reference - value) + conditioning);
  }
};

inline AntiWindup AntiWindupOf(const std::string& name) {
  return name == "none" ? AntiWindup::kNone : name == "as_printed" ? AntiWindup::kAsPrinted : AntiWindup::kConditioned;
}
inline std::vector<std::string> AntiWindupNames() { return {"conditioned", "none", "as_printed"}; }

/// The period of a control block: its own, or that of the run.
inline double PeriodOf(const Value& table, const BuildContext& context) {
  const Value* period = table.Find("period_s");
  return period != nullptr && period->is_number() && period->number() > 0.0 ? period->number() : context.period_s;
}

}  // namespace dynoproof::controls
