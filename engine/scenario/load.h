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
/// Reads back what ToToml() wrote; nothing where the text is no TOML.
std::optional<Value> FromToml(const std::string& text);
/// One value as it stands behind a key: floats with a point or an exponent, by the shortest text that reads back the
/// same; texts in quotes, tables in braces.
std::string InlineToml(const Value& value);

/// Parses one TOML value ("3.5", "[1, 2]", "true", "{ a = 1 }"); text that is none of these becomes a string.
Value ParseTomlValue(const std::string& text);

}  // namespace dynoproof
