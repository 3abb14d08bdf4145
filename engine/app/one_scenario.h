// The scenario of a command that takes one.
#pragma once

#include <optional>
#include <string>

#include "base/diagnostics.h"

namespace dynoproof::app {

/// The file of the scenario that a user names (FindScenarios()); a name that stands for several, as a folder's, is an error.
std::optional<std::string> OneScenario(const std::string& name, Diagnostics& diagnostics);

}  // namespace dynoproof::app
