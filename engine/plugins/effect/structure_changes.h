// Effects that change the structure of a drive line.
#pragma once

#include <memory>

#include "model/effect.h"

namespace dynoproof::effects {

/// A run of lumps becomes one soft rotor of 100 slices (thesis Sec. 2.3.1).
///
/// Places: rotor:NAME for each [plant.run.NAME] inertias = [...] that is a chain of spring-damper shafts, left by one
/// shaft at one of its ends, whose torques and loads do not reach beyond it and of whose inside no output is taken. The
/// chain is replaced by [plant.rotor.NAME]; the leaving shaft starts at its right end; a torque of the chain acts on
/// slices 6 to 95 (Sec. 2.3.2: the outer five on each side are not touched); outputs of the end inertias are taken from
/// the ends. The total inertia and the stiffness of the leaving shaft are then free values of the plan.
std::unique_ptr<Effect> DistributedInertia();

/// A rigid joint becomes a spring and damper: the inertia is split in two equal halves joined by k and c.
///
/// Places: inertia:NAME with something on both sides: at least two shafts, or a shaft and a torque entry or load. The
/// first half keeps the name, torques, loads and, of several shafts, the first one written; the second half NAME_b
/// takes the others. k -> infinity is the nominal model; the upper bound is as near as a solver comes.
std::unique_ptr<Effect> SeriesElasticity();

/// A shaft's torque gains k3 d^3. Places: shaft:NAME with law spring_damper and stiffness > 0.
std::unique_ptr<Effect> CubicStiffness();

}  // namespace dynoproof::effects
