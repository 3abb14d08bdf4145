// `reduce --data`: the shortest cut of a record with which a scenario still falls short, or that still has its fault.
#pragma once

#include <string>
#include <vector>

#include "app/app.h"
#include "model/registry.h"

namespace dynoproof::app {

struct RecordReduction {
  std::string scenario, data, map, check, out;  // `out`: the cut, as CSV
  std::vector<std::string> overrides;
  int most_runs = 100;
};

/// Prints what was cut off, keeps the JSON; the exit code.
int ReduceRecord(const RecordReduction& arguments, const Common& common);

}  // namespace dynoproof::app
