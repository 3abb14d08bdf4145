#include "app/measured.h"

#include <fmt/format.h>

#include "experiment/gaps.h"
#include "experiment/prepare.h"
#include "identification/bring_in.h"
#include "identification/start.h"
#include "model/effect.h"
#include "scenario/find.h"
#include "scenario/load.h"

namespace dynoproof::app {

std::optional<MeasuredCase> LoadMeasured(const std::string& scenario, const std::vector<std::string>& data,
                                         const std::vector<std::string>& maps, const std::vector<std::string>& holdout,
                                         const std::vector<std::string>& overrides, const Registry& registry,
                                         Diagnostics& diagnostics) {
  const int before = diagnostics.error_count();
  MeasuredCase result;
  const std::vector<std::string> files = FindScenarios(scenario, diagnostics);
  if (files.size() > 1) diagnostics.Error({scenario}, "names several scenarios", "name one");
  if (diagnostics.error_count() != before || files.empty()) return std::nullopt;
  result.file = files.front();
  // Everything that is wrong with the scenario is reported as `run` would.
  PrepareOptions options;
  options.overrides = overrides;
  const std::unique_ptr<Prepared> prepared = Prepare(result.file, options, registry, diagnostics);
  if (prepared == nullptr) return std::nullopt;
  result.plan = prepared->plan;
  result.own = prepared->data;
  result.own_fault = prepared->record_fault;
  const std::vector<SignalName> inputs = InputNames(*prepared->rig), outputs = OutputNames(*prepared->rig);
  const std::size_t records = data.size() + holdout.size();
  if (maps.size() > 1 && maps.size() != records) {
    diagnostics.Error({"--map"}, fmt::format("{} maps for {} records", maps.size(), records),
                      "one map for all records, or one each");
    return std::nullopt;
  }
  for (std::size_t i = 0; i < records; ++i) {
    const std::string& file = i < data.size() ? data[i] : holdout[i - data.size()];
    const std::string map = maps.empty() ? "" : maps.size() == 1 ? maps[0] : maps[i];
    std::optional<MappedRecord> mapped = OpenRecord(file, map, inputs, outputs, diagnostics);
    if (!mapped) continue;
    for (MappedRecord& part : PartsBetweenGaps(*std::move(mapped))) {
      if (!identification::BringIn(result.plan, registry, part, diagnostics)) break;
      (i < data.size() ? result.data : result.holdout).push_back(std::move(part));
    }
  }
  if (diagnostics.error_count() != before) return std::nullopt;
  // One problem has one set of start values. A hold-out has its own, of its first samples.
  if (std::ranges::any_of(result.data, &MappedRecord::in_motion)) {
    for (MappedRecord& record : result.data) record.in_motion = true;
  }
  return result;
}

Start BeginAsRecorded(const Plan& plan, const Registry& registry, MappedRecord& record) {
  const Result<Start> start = identification::StartOf(plan, record, registry);
  if (!start.ok()) {
    record.notes.push_back("where it begins is not found: " + start.failure().ToString());
    return {};
  }
  if (start->empty()) return {};
  record.notes.push_back("the run starts where the record does: " + identification::ToText(*start));
  return *start;
}

}  // namespace dynoproof::app
