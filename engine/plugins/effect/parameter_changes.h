// Effects that change a value the plan already has: new = nominal (1 + delta).
#pragma once

#include <memory>

#include "model/effect.h"

namespace dynoproof::effects {

/// Places: inertia:NAME, rotor:NAME (the whole rotor).
std::unique_ptr<Effect> InertiaChange();
/// Places: shaft:NAME whose law has the key stiffness_Nm_per_rad, rotor:NAME; values of 0 stay 0 and are no place.
std::unique_ptr<Effect> StiffnessChange();
/// The same for damping_Nms_per_rad.
std::unique_ptr<Effect> DampingChange();
/// Places: parameter:NAME of a plant that has a section of parameters (`equations`).
std::unique_ptr<Effect> ParameterChange();

}  // namespace dynoproof::effects
