// What is wrong with a record before anybody compares it: time base, numbers, channels, and, against a scenario, units,
// signs, swapped columns and delays. Each finding says where and how often.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "diagnosis/terms.h"
#include "identification/estimation_problem.h"
#include "trace/record.h"

namespace dynoproof::diagnosis {

struct Finding {
  bool fault = true;  // false: worth knowing, and no reason to stop
  std::string
      kind;  // "gap", "jitter", "not_rising", "not_finite", "clipping", "constant", "short", "unit", "sign", ...
  std::string column;
  std::string text;  // one sentence with place and figures
  std::size_t count = 0;
  double at_s = 0.0;                 // the first place
  std::optional<double> nrmse = {};  // kind "distance": from the simulation
};

/// The record alone, column by column, as it stands in the file. A column of zeros is no fault where it is an input.
std::vector<Finding> CheckRecord(const trace::Record& record);

/// Mapped signals against what the scenario predicts for them.
Result<std::vector<Finding>> CheckAgainst(const EstimationProblem& problem);

/// How far each mapped output is from what the scenario predicts for it. A record that has nothing to do with the
/// scenario is a fault; one that a wrong model keeps away from its simulation is not: that is what `diagnose` is for.
Result<std::vector<Finding>> DistancesOf(const EstimationProblem& problem);

}  // namespace dynoproof::diagnosis
