// What the commands about measured data share: the scenario, its registry, and records mapped onto it.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "app/app.h"
#include "experiment/prepare.h"
#include "experiment/records.h"
#include "model/plan.h"

namespace dynoproof::app {

struct MeasuredCase {
  std::string file;  // of the scenario
  Plan plan;         // its own effects applied
  std::vector<MappedRecord> data, holdout;
  std::shared_ptr<const MappedRecord> own;  // of the scenario's [record], where it names a file
  std::string own_fault;                    // why there is none although it does
};

/// Loads scenario and records, of each the parts between gaps in which nobody knows the inputs; one map serves all records, or
/// each its own (first those of --data, then --holdout).
/// Every fault goes to `diagnostics`.
std::optional<MeasuredCase> LoadMeasured(const std::string& scenario, const std::vector<std::string>& data,
                                         const std::vector<std::string>& maps, const std::vector<std::string>& holdout,
                                         const std::vector<std::string>& overrides, const Registry& registry,
                                         Diagnostics& diagnostics);

/// The start of a record that begins in motion, for a run of it; its notes say it. Empty where it does not, or none is found.
Start BeginAsRecorded(const Plan& plan, const Registry& registry, MappedRecord& record);

/// The commands themselves.
void AddCheckData(Command program);
void AddIdentify(Command program);

}  // namespace dynoproof::app
