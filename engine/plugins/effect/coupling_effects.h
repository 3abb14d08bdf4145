// Effects of hydrodynamic couplings (thesis chapter 4).
#pragma once

#include <memory>

#include "model/effect.h"

namespace dynoproof::effects {

/// A Kelvin-Voigt coupling becomes the oil model (4.20). Places: shaft:NAME with law kelvin_voigt without drift. Of k_p
/// and kappa_w only the product shows: the plan gets k_p = 1 m^3 and the product as kappa_w. No value is neutral: with
/// K = k_p kappa_w -> infinity at K / kappa_p = c the law tends to a Kelvin-Voigt coupling.
std::unique_ptr<Effect> OilDynamics();

/// The damping of a Kelvin-Voigt coupling falls with the running time: c (1 - delta (1 - exp(-t / tau))). Places: as
/// above, where the damping is not 0.
std::unique_ptr<Effect> ViscosityDrift();

}  // namespace dynoproof::effects
