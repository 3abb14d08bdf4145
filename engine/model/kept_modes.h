// How much of its soft rotors a plan simulates: `plant.modes_below_Hz` of a drive line.
#pragma once

#include "model/plan.h"

namespace dynoproof {

/// Whether the plant is a line with soft rotors.
bool HasSoftRotors(const Plan& plan);
/// The frequency [Hz] below which modes are kept; 0: all.
double ModesBelow(const Plan& plan);
void KeepModesBelow(Plan& plan, double frequency_Hz);

}  // namespace dynoproof
