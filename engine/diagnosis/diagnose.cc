#include "diagnosis/diagnose.h"

#include <algorithm>

#include "diagnosis/pipeline.h"
#include "identification/start.h"

namespace dynoproof::diagnosis {
namespace {

/// Whether records that passed for being in motion are so without their hum; where one is, all count as that.
void LookForMotion(const Plan& plan, const Registry& registry, std::vector<MappedRecord>& records) {
  const bool moves = std::ranges::any_of(records, [&](const MappedRecord& record) {
    return record.in_motion && !identification::MotionAtStart({plan, {record}, registry}).empty();
  });
  for (MappedRecord& record : records) record.in_motion = moves;
}

Result<Diagnosis> DiagnoseFrom(const Plan& plan, const std::vector<MappedRecord>& data,
                               const std::vector<MappedRecord>& holdout, const Registry& registry,
                               const DiagnoseOptions& options, const Before& before) {
  options.progress("levels", 0.0);
  const auto pipeline = Pipeline::Of(plan, data, holdout, registry, options, before);
  if (!pipeline.ok()) return pipeline.failure();
  Result<Answer> answer = (*pipeline)->Decide();
  if (!answer.ok()) return answer.failure();
  if (const std::vector<Hum>& hum = (*pipeline)->hum(); !hum.empty()) {
    std::vector<MappedRecord> cleaned = data, others = holdout;
    TakeOff(hum, cleaned);
    TakeOff((*pipeline)->HumIn(holdout), others);
    for (auto* some : {&cleaned, &others}) LookForMotion(plan, registry, *some);
    Before next{before.begun_at, (*pipeline)->simulations(), before.notes, before.took_hum_off + 1};
    next.notes.push_back("hum that no model here makes is taken off the records: " + ToText(hum));
    return DiagnoseFrom(plan, cleaned, others, registry, options, next);
  }
  const auto in_motion = [](const std::vector<MappedRecord>& some) {
    return std::ranges::any_of(some, &MappedRecord::in_motion);
  };
  if (!IsExactCause(*answer) || !(in_motion(data) || in_motion(holdout)))
    return (*pipeline)->Report(*std::move(answer));
  // The nominal model has told that they begin in motion. A cause that acts from the first sample on looks like that, and starts that
  // are fitted along hide where it sits. Where a model leaves nothing but noise from the scenario's own start, that is the plainer one.
  std::vector<MappedRecord> at_rest = data, holdout_at_rest = holdout;
  for (auto* some : {&at_rest, &holdout_at_rest}) {
    for (MappedRecord& record : *some) record.in_motion = false;
  }
  Before next{before.begun_at, (*pipeline)->simulations(), before.notes};
  next.notes.push_back(
      "from the scenario's own start this leaves nothing but noise: the records are taken to begin there");
  const auto second = Pipeline::Of(plan, at_rest, holdout_at_rest, registry, options, next);
  if (!second.ok()) return (*pipeline)->Report(*std::move(answer));
  Result<Answer> plainer = (*second)->DecideAsPlainlyAs(*answer);
  if (plainer.ok() && IsExactCause(*plainer) && EffectsIn(*plainer) <= EffectsIn(*answer))
    return (*second)->Report(*std::move(plainer));
  return (*pipeline)->Report(*std::move(answer));
}

}  // namespace

Result<Diagnosis> Diagnose(const Plan& plan, const std::vector<MappedRecord>& data,
                           const std::vector<MappedRecord>& holdout, const Registry& registry,
                           const DiagnoseOptions& options) {
  return DiagnoseFrom(plan, data, holdout, registry, options, {});
}

}  // namespace dynoproof::diagnosis
