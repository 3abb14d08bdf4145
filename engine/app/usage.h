// Errors of usage: what the parser of the command line refused, in the words of the other diagnostics.
#pragma once

#include <CLI/CLI.hpp>

#include "base/diagnostics.h"

namespace dynoproof::app {

/// The faults of a call, each with the nearest command or option as a suggestion.
Diagnostics UsageFaults(const CLI::App& program, const CLI::ParseError& error);

}  // namespace dynoproof::app
