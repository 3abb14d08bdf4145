#include "thesis/studies_identification.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "base/random.h"
#include "experiment/prepare.h"
#include "experiment/records.h"
#include "experiment/run_scenario.h"
#include "identification/identify.h"
#include "scenario/find.h"
#include "scenario/load.h"
#include "score/series.h"
#include "thesis/study_parameters.h"

namespace dynoproof {
namespace {

std::vector<std::string> Texts(const Value& parameters, const char* key) {
  std::vector<std::string> texts;
  const Value* list = parameters.Find(key);
  for (const Value& one : list != nullptr && list->is_array() ? list->array() : Value::Array{}) {
    if (one.is_string()) texts.push_back(one.string());
  }
  return texts;
}

/// The scenario's own run as a record of these outputs, with white noise of `noise` of each one's spread.
Result<MappedRecord> OwnRecord(const Registry& registry, const Plan& plan, const std::vector<std::string>& outputs,
                               double noise, std::uint64_t seed) {
  Diagnostics diagnostics;
  const std::unique_ptr<Prepared> prepared = Prepare(plan, {}, registry, diagnostics);
  if (prepared == nullptr) return BadStudy(diagnostics.Format());
  const Result<Course> course = Play(*prepared);
  if (!course.ok()) return course.failure();
  const Samples& samples = course->samples;
  MappedRecord record;
  record.file = "its own run";
  record.end_s = samples.time.back();
  const auto time = std::make_shared<const std::vector<double>>(samples.time);
  for (std::size_t i = 0; i < prepared->rig->inputs.size(); ++i)
    record.inputs[prepared->rig->inputs[i].name] = {time,
                                                    std::make_shared<const std::vector<double>>(samples.inputs[i])};
  for (std::size_t j = 0; j < prepared->rig->outputs.size(); ++j) {
    const std::string& name = prepared->rig->outputs[j].name;
    if (std::ranges::find(outputs, name) == outputs.end()) continue;
    std::vector<double> values = samples.outputs[j];
    const double sigma = noise * score::StandardDeviation(values);
    for (std::size_t i = 0; i < values.size(); ++i) values[i] += sigma * RandomNormal(seed, j, i);
    record.outputs[name] = {time, std::make_shared<const std::vector<double>>(std::move(values))};
  }
  if (record.outputs.size() != outputs.size()) return BadStudy("an output of \"outputs\" does not exist");
  return record;
}

/// Fits the numbers `free` of a scenario, begun at `begin` times what they are, to a record of its own run, and says how far
/// the worst of them is from what it was made with, relative to it.
Result<Figure> OwnRecordIdentified(const Registry& registry, const Value& parameters) {
  Diagnostics diagnostics;
  const std::vector<std::string> files = FindScenarios(parameters.TextOr("scenario"), diagnostics);
  const std::optional<Plan> truth =
      files.size() == 1 ? LoadPlan(files[0], Texts(parameters, "set"), diagnostics) : std::nullopt;
  if (!truth) return BadStudy("needs a \"scenario\"\n" + diagnostics.Format());
  const Result<MappedRecord> record =
      OwnRecord(registry, *truth, Texts(parameters, "outputs"), parameters.NumberOr("noise", 0.0),
                static_cast<std::uint64_t>(parameters.NumberOr("seed", 1.0)));
  if (!record.ok()) return record.failure();
  Plan begun = *truth;
  identification::IdentifyOptions options;
  options.starts = 1;
  if (!parameters.TextOr("method").empty()) options.method = parameters.TextOr("method");
  if (!identification::Methods().contains(options.method)) return BadStudy("there is no method " + options.method);
  for (const std::string& key : Texts(parameters, "free")) {
    Value* number = begun.root.FindPath(key);
    if (number == nullptr || !number->is_number()) return BadStudy(fmt::format("\"{}\" is no number", key));
    *number = Value(number->number() * parameters.NumberOr("begin", 1.0));
    options.keys.push_back({key, std::nullopt});
  }
  const Result<identification::Identified> found = identification::Identify(begun, {*record}, registry, options);
  if (!found.ok()) return found.failure();
  double worst = 0.0;
  for (const identification::IdentifiedValue& one : found->values)
    worst = std::max(worst, std::abs(one.value / truth->root.FindPath(one.key)->number() - 1.0));
  return Figure{worst, "1"};
}

}  // namespace

std::map<std::string, Study, std::less<>> IdentificationStudies() {
  return {{"own_record_identified", OwnRecordIdentified}};
}

}  // namespace dynoproof
