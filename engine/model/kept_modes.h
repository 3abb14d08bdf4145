// How much of its soft rotors a plan simulates: `plant.rotor_modes` of a drive line.
#pragma once

#include "model/plan.h"

namespace dynoproof {

/// Whether the plant is a line with soft rotors.
bool HasSoftRotors(const Plan& plan);
/// How many modes are kept; 0: all.
int RotorModes(const Plan& plan);
void SetRotorModes(Plan& plan, int modes);

}  // namespace dynoproof
