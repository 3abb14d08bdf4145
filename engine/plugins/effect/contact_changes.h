// Effects of shafts with play.
#pragma once

#include <memory>

#include "model/effect.h"

namespace dynoproof::effects {

/// A shaft gains play where the model has none. Places: shaft:NAME with law spring_damper and stiffness > 0. The law
/// becomes phase_plane, or dead_zone where the shaft has no damping (the two are then the same).
std::unique_ptr<Effect> BacklashEffect();
/// The play is off: half_gap_rad = nominal (1 + delta). Places: shaft:NAME with a law with play.
std::unique_ptr<Effect> GapChange();
/// Damping while the sides do not touch, thesis (3.5), (3.13)-(3.15). Places: shaft:NAME with dead_zone,
/// revised_dead_zone or phase_plane; the law becomes its damped one.
std::unique_ptr<Effect> ContactFreeDamping();

}  // namespace dynoproof::effects
