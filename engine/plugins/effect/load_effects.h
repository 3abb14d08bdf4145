// Effects that add a law between a body and the ground: frictions and loads.
//
// Each adds one table [plant.load.NAME] with NAME the effect's name (with the place's name behind it when that is
// taken) and never changes an existing one. Places: every inertia and every soft rotor of a drive line; on a rotor the
// law acts on the whole body.
#pragma once

#include <memory>

#include "model/effect.h"

namespace dynoproof::effects {

std::unique_ptr<Effect> ViscousFriction();
std::unique_ptr<Effect> CoulombFriction();
std::unique_ptr<Effect> StribeckFriction();
std::unique_ptr<Effect> AsymmetricFriction();
std::unique_ptr<Effect> DahlFriction();
std::unique_ptr<Effect> ConstantLoad();
std::unique_ptr<Effect> QuadraticDrag();
std::unique_ptr<Effect> TorqueRipple();

}  // namespace dynoproof::effects
