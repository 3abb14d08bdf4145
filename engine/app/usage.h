// Errors of usage: what the parser of the command line refused, in the words of the other diagnostics.
#pragma once

#include <CLI/CLI.hpp>

#include "base/diagnostics.h"

namespace dynoproof::app {

/// What is wrong with the call, with the command or option that was probably meant.
Diagnostics UsageFaults(const CLI::App& program, const CLI::ParseError& error);

}  // namespace dynoproof::app
