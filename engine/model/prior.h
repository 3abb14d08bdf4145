// [prior]: how well the numbers of a scenario are known, where that is stated and not left to the plant:
//
//   [prior]
//   "plant.inertia.I1" = "2 %"                         # standard deviation of its logarithm
//   "plant.shaft.k2.stiffness_Nm_per_rad" = "fitted"   # to records: it may have swallowed what the model lacks
//   "plant.load.bearing.T_c_Nm" = "free"               # nobody knows it: no prior at all
//   "plant.load.slide.T_c_Nm" = { spread = "5 %", per_record = true }   # differs so much from record to record
#pragma once

#include <limits>
#include <string>
#include <vector>

#include "model/plant_traits.h"

namespace dynoproof {

/// The spread of a number without a prior.
inline constexpr double kNoPrior = std::numeric_limits<double>::infinity();

/// Reports what is no number of the plan, and what is no prior.
void CheckPriors(const Plan& plan, Diagnostics& diagnostics);

/// The numbers that the plant knows to a tolerance only, with what the plan states of them; numbers that it states of its own
/// accord come last.
std::vector<NuisanceParameter> NuisancesWithPriors(const PlantTraits& plant, const Plan& plan);
/// A number that differs from record to record around a common value, as friction does with warmth.
struct NumberThatDiffers {
  std::string path;
  double spread;  // standard deviation of the logarithm of a record's value over the common one
};
/// Those that [prior] states.
std::vector<NumberThatDiffers> NumbersThatDiffer(const Plan& plan);
/// Whether [prior] says something of the number of that path; of one that differs from record to record it says nothing of the
/// common value.
bool PriorIsStated(const Plan& plan, const std::string& path);

}  // namespace dynoproof
