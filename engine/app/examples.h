// What `describe` shows of a law or effect as a scenario writes it.
#pragma once

#include <string>

#include "model/effect.h"
#include "model/registry.h"

namespace dynoproof::app {

/// The law as [plant.shaft.k2] or [plant.load.NAME] of the drive line that `dynoproof new scenario` writes: every key
/// that must be given, for the built-in laws with numbers that fit there. tests/acceptance/first_steps_test.py runs
/// every one of them.
std::string ExampleOf(const PluginInfo& law);

/// The effect as [[effect]], with every parameter at a value within its bounds.
std::string ExampleOf(const EffectInfo& effect);

}  // namespace dynoproof::app
