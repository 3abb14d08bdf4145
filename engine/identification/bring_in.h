// From a mapped record to one that a scenario can be compared with and fitted to.
#pragma once

#include "base/diagnostics.h"
#include "experiment/records.h"
#include "model/plan.h"
#include "model/registry.h"

namespace dynoproof::identification {

/// Brings a record onto the plan's clock, looks whether it begins in motion, and lets inputs of which nobody says it do
/// between their samples what its outputs support; `notes` says all that. A time in another unit than the scenario's is
/// a fault, and then this is false.
bool BringIn(const Plan& plan, const Registry& registry, MappedRecord& record, Diagnostics& diagnostics);

}  // namespace dynoproof::identification
