#include "estimation/built_run.h"

#include "experiment/drive_by_record.h"
#include "model/effect.h"

namespace dynoproof::estimation {

Result<BuiltRun> BuildRun(Plan plan, const MappedRecord& record, const Registry& registry,
                          mechanics::Decompositions* known) {
  BuiltRun run;
  run.records = std::make_unique<Records>();
  plan.root["run"]["solver"] = Value("realtime");
  DriveByRecord(record, plan, *run.records);
  Diagnostics diagnostics;
  if (ApplyEffects(registry, plan, diagnostics)) run.rig = Rig::Build(plan, registry, *run.records, diagnostics);
  if (run.rig == nullptr) {
    const auto& faults = diagnostics.items();
    return Failure{faults.empty() ? "the plan cannot be built" : faults.front().message, plan.id, {}, 2};
  }
  Result<std::unique_ptr<Solver>> solver = MakeRealtimeSolver(*run.rig, known);
  if (!solver.ok()) return solver.failure();
  run.solver = *std::move(solver);
  return run;
}

}  // namespace dynoproof::estimation
