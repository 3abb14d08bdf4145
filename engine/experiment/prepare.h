// From a scenario file to something that can run: plan loaded, effects applied, rig built, checks understood. Every
// fault of all of these is found before anything runs.
#pragma once

#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "experiment/checks.h"
#include "experiment/golden_place.h"
#include "experiment/measured_record.h"
#include "model/registry.h"
#include "sim/rig.h"

namespace dynoproof {

/// The state that a run starts from, over what the scenario says: "plant.shaft.k1.initial_twist_rad" and its value.
using Start = std::map<std::string, double>;

struct Prepared {
  Plan plan;  // effects applied
  std::string title;
  std::unique_ptr<Rig> rig;
  std::vector<std::unique_ptr<CheckPlan>> checks;
  std::shared_ptr<Records> records;
  std::vector<std::string> notes;    // what a reader of the result should know
  std::vector<std::string> changes;  // by --set, "plant.inertia.I3 = 0.6 (was 0.5)"
  const Registry* registry = nullptr;
  std::optional<RecordSettings> record;
  std::shared_ptr<const MappedRecord> data;  // of [record] file: drives the inputs it has
  GoldenPlace golden;                        // where its golden data lie
  bool checks_as_written = true;             // no --set gave other checks than the scenario's own
  std::string record_fault;                  // why there is no such record: the scenario fails
  /// [variant.NAME]: the scenario with some values changed; its outputs are recorded as OUTPUT_NAME.
  struct Variant {
    std::string name;
    Plan plan;
    std::unique_ptr<Rig> rig;
  };
  std::vector<Variant> variants;
};

struct PrepareOptions {
  std::vector<std::string> overrides;  // --set
  std::string solver;                  // --solver; empty: the scenario's own
  const MappedRecord* data = nullptr;  // --data: drives the inputs it has
  std::string golden = {};             // --golden: folder of golden data; empty: where they stand
  Start start = {};                    // of the run with `data`, where nothing else says one
};

/// Null when there was any error.
std::unique_ptr<Prepared> Prepare(const std::string& file, const PrepareOptions& options, const Registry& registry,
                                  Diagnostics& diagnostics);

/// The same for a plan that is already loaded.
std::unique_ptr<Prepared> Prepare(Plan plan, const PrepareOptions& options, const Registry& registry,
                                  Diagnostics& diagnostics);

/// The same experiment of another model: the records, golden data and checks of `like`, and a plan that is its plan with changed
/// values. Checks stay those that `like` states. Null when there was any error.
std::unique_ptr<Prepared> PrepareLike(const Prepared& like, Plan plan, Diagnostics& diagnostics);

/// The plan's plant starts where the first samples of a record say, when these say otherwise than the plan, in the
/// values that it declares as measured.
void StartFromRecord(const MappedRecord& data, const Registry& registry, Plan& plan);
void StartAt(const Start& start, Plan& plan);

}  // namespace dynoproof
