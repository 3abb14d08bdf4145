// Nominal values that a diagnosis may not take for exact, as the plant declares them: what a data sheet says of its
// parts, and the state the record starts from. Each is a normal deviate of the plan with a stated spread, fitted along
// with every hypothesis, so that a value a little off is neither an alarm nor credited to an effect.
#pragma once

#include <string>
#include <vector>

#include "model/registry.h"

namespace dynoproof::identification {

/// A number of a plan with a prior: value = nominal exp(spread z), or nominal + spread z, with z standard normal. The
/// logarithm keeps masses positive and makes half as unlikely as twice, however wide the prior.
struct Nuisance {
  std::string path;  // "plant.inertia.I5"
  bool relative = true;
  double spread = 0.0;             // of the logarithm, or in its own unit
  bool start = false;              // belongs to the record, not to the model
  const Effect* effect = nullptr;  // the one that changes the same number, and where; null: none
  Place at = {};
  bool only_in_motion = false;  // of a start: only of records that begin otherwise than the plan does
};

/// All nuisance parameters of the plan: what its plant declares; `released`: those as well that are free only where nominal
/// values are let go.
std::vector<Nuisance> NuisancesOf(const Plan& plan, const Registry& registry, bool released = false);

/// Writes the values that belong to z (standard deviations) into the plan; values that are not there any more are
/// passed over.
void ApplyNuisances(const std::vector<Nuisance>& nuisances, const std::vector<double>& z, Plan& plan);

/// The value at z = 0 and at z.
struct NuisanceValue {
  double nominal, value;
};
NuisanceValue ValueOf(const Nuisance& nuisance, double z, const Plan& plan);

}  // namespace dynoproof::identification
