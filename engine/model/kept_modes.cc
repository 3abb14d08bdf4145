#include "model/kept_modes.h"

namespace dynoproof {

bool HasSoftRotors(const Plan& plan) {
  const Value* rotors = plan.root.FindPath("plant.rotor");
  return rotors != nullptr && rotors->is_table() && !rotors->table().empty();
}

double ModesBelow(const Plan& plan) { return plan.root.NumberOr("plant.modes_below_Hz", 0.0); }

void KeepModesBelow(Plan& plan, double frequency_Hz) { plan.root["plant"]["modes_below_Hz"] = Value(frequency_Hz); }

}  // namespace dynoproof
