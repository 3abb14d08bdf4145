// Checks that would see what passes: golden tolerances that are narrow enough for the holes, and wide enough for every build.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "probe/probe.h"

namespace dynoproof::probe {

/// The golden comparison of an output, with the half-width of its tube.
struct Proposal {
  std::string output;
  double relative_width = 0.0;  // over the output's nominal
  double builds = 0.0;          // how far two solvers are apart there: what a build may differ by is less
  std::vector<std::string>
      sees;  // holes that would be seen at half of what is usual: "sensor_offset at output:omega_1"
};

/// As few outputs as see all holes that any can. `apart`: by output, how far another solver's run is from this one, over the nominal;
/// an output without an entry is not proposed. A tube is never narrower than ten times that, nor than the default of golden traces.
std::vector<Proposal> Propose(const std::vector<Finding>& findings, const std::map<std::string, double>& apart);

/// The lines for the scenario and for its golden tolerances.
std::string ToLines(const std::vector<Proposal>& proposals, bool states_golden);

}  // namespace dynoproof::probe
