// TOML <-> Plan: reads a scenario with its includes and overrides, and writes a plan back as TOML.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "base/diagnostics.h"
#include "model/plan.h"

namespace dynoproof {

/// Reads a scenario file: its includes first (relative to the file that names them, later ones win), then the file
/// itself, then the overrides "path.to.key=value" in order. Every fault goes to `diagnostics` (of a file with a syntax
/// error the first one); nothing is returned only when no tree could be read.
std::optional<Plan> LoadPlan(const std::string& file, const std::vector<std::string>& overrides,
                             Diagnostics& diagnostics);

/// The plan as TOML: what is stored with a trace. Reading it back gives an equal tree.
std::string ToToml(const Value& root);
/// One value as it stands behind a key: floats with a point or an exponent, by the shortest text that reads back the
/// same; texts in quotes, tables in braces.
std::string InlineToml(const Value& value);

/// Parses one TOML value ("3.5", "[1, 2]", "true", "{ a = 1 }"); text that is none of these becomes a string.
Value ParseTomlValue(const std::string& text);

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
