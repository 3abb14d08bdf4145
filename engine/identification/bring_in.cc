#include "identification/bring_in.h"

#include <optional>
#include <string>
#include <utility>

#include "experiment/drive_by_record.h"
#include "experiment/prediction_windows.h"
#include "identification/between_samples.h"
#include "identification/start.h"

namespace dynoproof::identification {

bool BringIn(const Plan& plan, const Registry& registry, MappedRecord& record, Diagnostics& diagnostics) {
  if (const std::optional<ForeignTime> foreign = ForeignTimeScale(record, plan)) {
    diagnostics.Error({record.file}, foreign->what, foreign->way_out);
    return false;
  }
  record = OntoClock(std::move(record), plan);
  // Windows start from states of their own, which would be estimated here for nothing.
  if (!record.outputs.empty() && !PredictionWindow(plan)) {
    const std::string motion = MotionAtStart({plan, {record}, registry});
    record.in_motion = !motion.empty();
    if (record.in_motion) record.notes.push_back("the record begins in motion, the scenario does not: " + motion);
  }
  ChooseBetween(plan, registry, record);
  return true;
}

}  // namespace dynoproof::identification
