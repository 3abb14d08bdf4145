// A scenario as a Functional Mock-up Unit for co-simulation (FMI 2.0): which of its numbers an importer sees, the file that holds it,
// and the run behind it. The unit holds the scenario and a small shared library that starts this program and asks it for each
// communication step (needsExecutionTool): both solvers' code stays one, and a run that dies takes no importer with it.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "base/diagnostics.h"
#include "base/status.h"
#include "experiment/prepare.h"

namespace dynoproof::fmu {

struct Variable {
  std::string name, unit, description;
  double start = 0.0, nominal = 1.0;
};

/// What an importer sees. Value references count through inputs, outputs and parameters, in this order.
struct Fmu {
  std::string id, identifier, title, guid;
  double period_s = 1e-4, duration_s = 1.0;
  std::vector<Variable> inputs;      // those of the scenario that a source drives; start: its value at t = 0
  std::vector<Variable> outputs;     // start: at t = 0
  std::vector<Variable> parameters;  // numbers of the plant that are known to a tolerance, by their path
};

/// Of a prepared scenario. Fails where its run does not start.
Result<Fmu> FmuOf(const Prepared& scenario);

/// modelDescription.xml
std::string ModelDescription(const Fmu& unit);

/// Writes the unit: description, scenario in one file, shared library, the program that exported it.
Status Write(const std::filesystem::path& file, const Fmu& unit, const Plan& plan);

/// Answers an importer's questions about the scenario of a file over that socket until it hangs up. Returns whether all went well.
bool Serve(int socket, const std::string& scenario, const Registry& registry);

}  // namespace dynoproof::fmu
