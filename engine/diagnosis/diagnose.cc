#include "diagnosis/diagnose.h"

#include <fmt/format.h>

#include <algorithm>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "diagnosis/pipeline.h"
#include "diagnosis/taken_off.h"
#include "identification/between_samples.h"
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

/// Lets the inputs be held of which it was guessed that they do otherwise between their samples. Whether there are any.
bool Hold(const Plan& plan, std::vector<MappedRecord>& records) {
  bool changes = false;
  for (MappedRecord& record : records) {
    changes = changes || std::ranges::any_of(record.guessed, [&](const std::string& name) {
                return record.between.at(name) != "held";
              });
    record = identification::WithBetween(std::move(record), plan, "held");
  }
  return changes;
}

/// The scenario, records and options of a search.
struct Question {
  const Plan& plan;
  const Registry& registry;
  const DiagnoseOptions& options;
  const std::vector<MappedRecord>&data, &holdout;
  const Before& before;
};

/// Returns what the next search starts with: the simulations that were made so far, and a note that says why another search is made.
Before After(const Pipeline& search, Before before, const std::string& why) {
  before.simulations = search.simulations();
  before.notes.push_back(why);
  return before;
}

/// What inputs do between their samples was guessed beside a model that lacks the cause: a lag in it looks like half a sample. Where a
/// model leaves nothing but noise with inputs that are held, as a control holds them, that is the answer.
std::optional<Result<Diagnosis>> WithHeldInputs(const Question& asked, const Pipeline& first, const Answer& answer) {
  std::vector<MappedRecord> data = asked.data, holdout = asked.holdout;
  const bool guessed = Hold(asked.plan, data), holdout_guessed = Hold(asked.plan, holdout);
  if (answer.settled.verdict == Conclusion::kNoEffect || IsExactCause(answer) || !(guessed || holdout_guessed))
    return {};
  const Before next =
      After(first, asked.before,
            "with inputs that are held between their samples this leaves nothing but noise: they count as held");
  const auto second = Pipeline::Of(asked.plan, data, holdout, asked.registry, asked.options, next);
  if (!second.ok()) return {};
  Result<Answer> held = (*second)->Decide();
  if (!held.ok() || !IsExactCause(*held)) return {};
  return (*second)->Report(*std::move(held));
}

/// The nominal model has told that records begin in motion. A cause that acts from the first sample on looks like that, and starts that
/// are fitted along hide where it sits. Where a model leaves nothing but noise from the scenario's own start, that is the plainer one.
std::optional<Result<Diagnosis>> FromTheOwnStart(const Question& asked, const Pipeline& first, const Answer& answer) {
  std::vector<MappedRecord> data = asked.data, holdout = asked.holdout;
  bool in_motion = false;
  for (auto* some : {&data, &holdout}) {
    for (MappedRecord& record : *some) in_motion = std::exchange(record.in_motion, false) || in_motion;
  }
  if (!IsExactCause(answer) || !in_motion) return {};
  const Before next =
      After(first, asked.before,
            "from the scenario's own start this leaves nothing but noise: the records are taken to begin there");
  const auto second = Pipeline::Of(asked.plan, data, holdout, asked.registry, asked.options, next);
  if (!second.ok()) return {};
  Result<Answer> plainer = (*second)->DecideAsPlainlyAs(answer);
  if (!plainer.ok() || !IsExactCause(*plainer) || EffectsIn(*plainer) > EffectsIn(answer)) return {};
  return (*second)->Report(*std::move(plainer));
}

Result<Diagnosis> DiagnoseFrom(const Question& asked) {
  const auto& [plan, registry, options, data, holdout, before] = asked;
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
    Before next = After(**pipeline, before, "hum that no model here makes is taken off the records: " + ToText(hum));
    next.took_hum_off += 1;
    return DiagnoseFrom({plan, registry, options, cleaned, others, next});
  }
  if (const std::optional<Course>& course = (*pipeline)->course()) {
    const std::vector<MappedRecord> again = OnCourse(data, plan, course->between),
                                    others = OnCourse(holdout, plan, course->between);
    Before next =
        After(**pipeline, before,
              fmt::format("beside {} inputs are {} between their samples: {:.2g} times as much is left then as "
                          "with what was guessed beside the nominal model",
                          course->beside, course->between, course->times));
    next.read_again = true;
    next.journal = (*pipeline)->journal();
    return DiagnoseFrom({plan, registry, options, again, others, next});
  }
  if (const std::optional<Drifts>& drifts = (*pipeline)->drifts()) {
    std::vector<MappedRecord> cleaned = data, others = holdout;
    TakeOff(drifts->of_sensors, cleaned);
    TakeOff((*pipeline)->DriftsInHoldout(), others);
    Before next =
        After(**pipeline, before,
              "sensors that drift, beside every model here, are taken off the records, by the end of the data " +
                  ToText(drifts->of_sensors));
    next.took_drifts_off += 1;
    next.journal = (*pipeline)->journal();
    return DiagnoseFrom({plan, registry, options, cleaned, others, next});
  }
  for (const auto& otherwise : {WithHeldInputs, FromTheOwnStart}) {
    if (std::optional<Result<Diagnosis>> told = otherwise(asked, **pipeline, *answer)) return *std::move(told);
  }
  return (*pipeline)->Report(*std::move(answer));
}

}  // namespace

Result<Diagnosis> Diagnose(const Plan& plan, const std::vector<MappedRecord>& data,
                           const std::vector<MappedRecord>& holdout, const Registry& registry,
                           const DiagnoseOptions& options) {
  return DiagnoseFrom({plan, registry, options, data, holdout, {}});
}

}  // namespace dynoproof::diagnosis
