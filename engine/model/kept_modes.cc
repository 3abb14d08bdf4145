#include "model/kept_modes.h"

namespace dynoproof {

bool HasSoftRotors(const Plan& plan) {
  const Value* rotors = plan.root.FindPath("plant.rotor");
  return rotors != nullptr && rotors->is_table() && !rotors->table().empty();
}

int RotorModes(const Plan& plan) {
  const Value* written = plan.root.FindPath("plant.rotor_modes");
  return written != nullptr && written->is_integer() ? static_cast<int>(written->integer()) : 0;
}

void SetRotorModes(Plan& plan, int modes) { plan.root["plant"]["rotor_modes"] = Value(std::int64_t{modes}); }

}  // namespace dynoproof
