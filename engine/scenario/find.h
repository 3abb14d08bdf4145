// Where scenarios lie, and what they are called.
#pragma once

#include <string>
#include <vector>

#include "base/diagnostics.h"

namespace dynoproof {

/// The folder with the scenarios: $DYNOPROOF_SCENARIOS, else that of the installation or source tree that this program
/// belongs to, wherever it was moved; relative where the current folder is in that tree.
std::string ScenarioFolder();

/// Resolves what a user names: a file, a folder, an id ("r2r/soft_rotor_setup_1") or the start of ids ("pressure/").
/// Returns files; an unknown name becomes a diagnostic with the nearest id.
std::vector<std::string> FindScenarios(const std::string& name, Diagnostics& diagnostics);

/// The id of a scenario file: its path below the scenario folder without ".toml"; elsewhere the file's stem.
std::string ScenarioId(const std::string& file);

/// Whether a scenario file belongs to the user: it lies outside the scenario folder. A plan without a file does not.
bool IsOwnScenario(const std::string& file);

/// What a command takes for this file: its id where that names it, else the file itself.
std::string CallName(const std::string& file);

}  // namespace dynoproof
