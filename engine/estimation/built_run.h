// A plan driven by a record, built and ready to run: what a prediction needs and nothing else, neither checks nor golden
// data nor files.
#pragma once

#include <memory>

#include "base/status.h"
#include "experiment/records.h"
#include "linear/decompositions.h"
#include "sim/rig.h"
#include "sim/solver.h"

namespace dynoproof::estimation {

struct BuiltRun {
  std::unique_ptr<Records> records;
  std::unique_ptr<Rig> rig;
  std::unique_ptr<Solver> solver;  // `realtime`
};

/// `record`: on the clock of the plan (OntoClock). `known`: decompositions that other runs have made; may be null. Fails
/// where the plan cannot be built, with its first fault.
Result<BuiltRun> BuildRun(Plan plan, const MappedRecord& record, const Registry& registry,
                          mechanics::Decompositions* known = nullptr);

}  // namespace dynoproof::estimation
