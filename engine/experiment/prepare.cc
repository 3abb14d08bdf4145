#include "experiment/prepare.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "experiment/analysis.h"
#include "experiment/drive_by_record.h"
#include "model/prior.h"
#include "scenario/changes.h"
#include "scenario/load.h"

namespace dynoproof {
namespace {

std::vector<std::string> KeysOfSection(const Plan& plan, const char* section) {
  const Value* tables = plan.root.Find(section);
  return tables != nullptr ? KeysOf(*tables) : std::vector<std::string>{};
}

}  // namespace

void StartFromRecord(const MappedRecord& data, const Registry& registry, Plan& plan) {
  // What noise and a sensor's error make of the first sample is less than this share.
  constexpr double kSaysOtherwise = 0.01;
  for (const auto& [path, port, lower] : registry.PlantOf(plan).measured_starts) {
    Value* start = plan.root.FindPath(path);
    if (start == nullptr || !start->is_number()) continue;
    for (const auto& [name, series] : data.outputs) {
      const Value* of = plan.root.FindPath("output." + name + ".of");
      if (of == nullptr || !of->is_string() || of->string() != port || series.values->empty()) continue;
      const double first = series.values->front();
      const bool otherwise = std::abs(first - start->number()) > kSaysOtherwise * std::abs(start->number());
      if (otherwise && first >= lower) *start = Value(first);
    }
  }
}

namespace {

/// Reads the files that `replay` sources name, anywhere in the tree.
void ReadReplays(const Value& value, const std::string& folder, Records& records, Diagnostics& diagnostics) {
  if (value.is_array()) {
    for (const Value& item : value.array()) ReadReplays(item, folder, records, diagnostics);
  }
  if (!value.is_table()) return;
  for (const Value::Entry& entry : value.table()) ReadReplays(entry.value, folder, records, diagnostics);
  if (value.TextOr("type") != "replay" || value.TextOr("file").empty()) return;
  const std::string file = (std::filesystem::path(folder) / value.TextOr("file")).lexically_normal().string();
  const SignalName wanted{value.TextOr("column"), ""};
  Diagnostics faults;
  const std::optional<MappedRecord> mapped = OpenRecord(file, "", {wanted}, {}, faults);
  for (const Diagnostic& fault : faults.items())
    diagnostics.Error(value.Find("file")->where(), fault.message, fault.hint);
  if (mapped) records[value.TextOr("file") + "#" + value.TextOr("column")] = mapped->inputs.at(value.TextOr("column"));
}

/// `keep` of a variant: which of the scenario's outputs the trace holds of it. False where one is none.
bool KeepsOutputs(const Value& keep, const Plan& plan, Diagnostics& diagnostics) {
  const bool names = keep.is_array() && std::all_of(keep.array().begin(), keep.array().end(),
                                                    [](const Value& name) { return name.is_string(); });
  if (!names) {
    diagnostics.Error(keep.where(), "\"keep\" is no list of names", "keep = [\"NAME of an output\", ...]");
    return false;
  }
  const Value* outputs = plan.root.Find("output");
  bool all = true;
  for (const Value& name : keep.array()) {
    if (outputs != nullptr && outputs->Find(name.string()) != nullptr) continue;
    diagnostics.Error(name.where(), fmt::format("there is no output \"{}\" to keep", name.string()),
                      "a name of an [output.NAME]");
    all = false;
  }
  return all;
}

/// Builds every [variant.NAME]: a table laid over the scenario.
void BuildVariants(const Plan& plan, const Registry& registry, Prepared& prepared, Diagnostics& diagnostics) {
  const Value* tables = plan.root.Find("variant");
  if (tables == nullptr) return;
  if (!tables->is_table()) {
    diagnostics.Error(tables->where(), "\"variant\" is " + tables->KindName(), "write [variant.NAME...]");
    return;
  }
  for (const Value::Entry& entry : tables->table()) {
    if (!entry.value.is_table()) {
      diagnostics.Error(entry.value.where(), fmt::format("variant.{} is {}", entry.key, entry.value.KindName()),
                        "write a table of what it changes");
      continue;
    }
    Value changes = entry.value;
    if (const Value* keep = changes.Find("keep"); keep != nullptr && !KeepsOutputs(*keep, plan, diagnostics)) continue;
    changes.Erase("keep");
    Prepared::Variant variant{entry.key, plan, nullptr};
    variant.plan.root.Erase("variant");
    MergeInto(variant.plan.root, changes);
    variant.rig = Rig::Build(variant.plan, registry, *prepared.records, diagnostics);
    if (variant.rig != nullptr) prepared.variants.push_back(std::move(variant));
  }
}

}  // namespace

std::unique_ptr<Prepared> Prepare(Plan plan, const PrepareOptions& options, const Registry& registry,
                                  Diagnostics& diagnostics) {
  const int before = diagnostics.error_count();
  // What a scenario's own record is to drive, below.
  const bool has_record = options.data == nullptr && plan.root.FindPath("record.file") != nullptr;
  const std::optional<Plan> written = has_record ? std::optional(plan) : std::nullopt;
  auto prepared = std::make_unique<Prepared>();
  prepared->records = std::make_shared<Records>();
  if (!options.solver.empty()) plan.root["run"]["solver"] = Value(options.solver);
  if (options.data != nullptr) {
    DriveByRecord(*options.data, plan, *prepared->records);
  }
  const std::string folder = std::filesystem::path(plan.file).parent_path().string();
  if (const Value* inputs = plan.root.Find("input")) ReadReplays(*inputs, folder, *prepared->records, diagnostics);
  ApplyEffects(registry, plan, diagnostics);
  if (const Value* title = plan.root.Find("title"); title != nullptr && title->is_string())
    prepared->title = title->string();
  prepared->rig = Rig::Build(plan, registry, *prepared->records, diagnostics);
  prepared->registry = &registry;
  if (prepared->rig != nullptr && options.data == nullptr) BuildVariants(plan, registry, *prepared, diagnostics);
  // Without a rig the names alone serve, so that every fault of a file is reported in one go.
  Rig names;
  for (const std::string& name : KeysOfSection(plan, "input")) names.inputs.emplace_back().name = name;
  for (const std::string& name : KeysOfSection(plan, "output")) names.outputs.emplace_back().name = name;
  const Rig& rig = prepared->rig != nullptr ? *prepared->rig : names;
  ReadAnalysis(plan, rig, diagnostics);
  ReadExtension(plan, diagnostics);
  CheckPriors(plan, diagnostics);
  prepared->record = ReadRecordSettings(plan, rig, diagnostics);
  // A record is another experiment: the checks of the scenario's own excitation do not apply to it.
  if (options.data == nullptr) prepared->checks = ReadChecks(plan, rig, registry, diagnostics);
  prepared->golden = GoldenPlaceOf(plan, options.golden);
  prepared->plan = std::move(plan);
  if (diagnostics.error_count() != before) return nullptr;
  if (!has_record || prepared->record->file.empty()) return prepared;
  // The scenario's own record drives it: the same once more with the data, and with the scenario's checks.
  Result<MappedRecord> data = OpenRecord(*prepared->record, folder, *prepared->rig);
  if (!data.ok()) {
    prepared->record_fault = data.failure().ToString();
    return prepared;
  }
  const auto owned = std::make_shared<const MappedRecord>(OntoClock(*std::move(data), *written));
  PrepareOptions driven = options;
  driven.data = owned.get();
  prepared = Prepare(*written, driven, registry, diagnostics);
  if (prepared == nullptr) return nullptr;
  prepared->data = owned;
  prepared->checks = ReadChecks(prepared->plan, *prepared->rig, registry, diagnostics);
  return diagnostics.error_count() == before ? std::move(prepared) : nullptr;
}

void StartAt(const Start& start, Plan& plan) {
  for (const auto& [path, number] : start) {
    if (const Value* table = plan.root.FindPath(path.substr(0, path.rfind('.'))); table != nullptr && table->is_table())
      WriteNumber(plan.root, path, number);
  }
}

namespace {

/// [extension] start: "KEY=NUMBER", the state that was fitted along to the records of [extension] data. It belongs to
/// those and to no other. True where the plan now starts there.
bool StartAsFitted(const MappedRecord& data, Plan& plan, Diagnostics& diagnostics) {
  const Value *start = plan.root.FindPath("extension.start"), *hashes = plan.root.FindPath("extension.data");
  if (start == nullptr || !start->is_array() || hashes == nullptr || !hashes->is_array()) return false;
  const std::string hash = HashOf(data.file);
  const bool fitted = !hash.empty() && std::ranges::any_of(hashes->array(), [&hash](const Value& one) {
    return one.is_string() && one.string() == hash;
  });
  if (!fitted) return false;
  for (const Value& item : start->array()) {
    const std::string text = item.is_string() ? item.string() : "";
    const std::size_t equals = text.find('='), dot = text.substr(0, equals).rfind('.');
    const Value number = equals == std::string::npos ? Value() : ParseTomlValue(text.substr(equals + 1));
    Value* table = dot == std::string::npos ? nullptr : plan.root.FindPath(text.substr(0, dot));
    if (!number.is_number() || table == nullptr || !table->is_table()) {
      diagnostics.Error(item.where(), fmt::format("\"{}\" is no start of this scenario", text),
                        "write start = [\"path.to.key=NUMBER\"]");
      continue;
    }
    (*table)[text.substr(dot + 1, equals - dot - 1)] = number;
  }
  return true;
}

/// Whether "KEY=VALUE" gives a whole list of checks, not a key of one.
bool GivesChecks(const std::string& change) {
  return change.starts_with("check") && change.find_first_not_of(" \t", 5) == change.find('=');
}

/// What --set changes in a scenario: the first thing to suspect where a check fails.
std::vector<std::string> ChangesBySet(const std::string& file, const Plan& plan) {
  Diagnostics ignored;  // a scenario with a fault in it may be right with the change
  const std::optional<Plan> written = LoadPlan(file, {}, ignored);
  return written ? ChangesBetween(written->root, plan.root) : std::vector<std::string>();
}

}  // namespace

std::unique_ptr<Prepared> PrepareLike(const Prepared& like, Plan plan, Diagnostics& diagnostics) {
  const int before = diagnostics.error_count();
  auto prepared = std::make_unique<Prepared>();
  prepared->title = like.title;
  prepared->records = like.records;
  prepared->registry = like.registry;
  prepared->record = like.record;
  prepared->data = like.data;
  prepared->golden = like.golden;
  prepared->checks_as_written = like.checks_as_written;
  prepared->rig = Rig::Build(plan, *like.registry, *like.records, diagnostics);
  if (prepared->rig != nullptr && like.data == nullptr) BuildVariants(plan, *like.registry, *prepared, diagnostics);
  prepared->checks = ReadChecks(like.plan, *like.rig, *like.registry, diagnostics);
  prepared->plan = std::move(plan);
  return diagnostics.error_count() == before ? std::move(prepared) : nullptr;
}

std::unique_ptr<Prepared> Prepare(const std::string& file, const PrepareOptions& options, const Registry& registry,
                                  Diagnostics& diagnostics) {
  const int before = diagnostics.error_count();
  std::optional<Plan> plan = LoadPlan(file, options.overrides, diagnostics);
  for (const std::string& change : options.overrides) {
    if (options.data == nullptr || !change.starts_with("run.duration_s")) continue;
    diagnostics.Error({"--set"}, "run.duration_s cannot be set: the record says how long the run lasts",
                      "shorten the record: rows = [FIRST, LAST] in the map file");
  }
  if (!plan) return nullptr;
  std::vector<std::string> changes;
  if (!options.overrides.empty()) changes = ChangesBySet(file, *plan);
  const bool as_fitted = options.data != nullptr && StartAsFitted(*options.data, *plan, diagnostics);
  if (options.data != nullptr && !as_fitted) {
    StartFromRecord(*options.data, registry, *plan);
    StartAt(options.start, *plan);
  }
  std::unique_ptr<Prepared> prepared = Prepare(std::move(*plan), options, registry, diagnostics);
  if (prepared != nullptr && as_fitted)
    prepared->notes.push_back("starts as the diagnosis of this record found it: [extension] start");
  if (prepared != nullptr && !options.overrides.empty()) {
    prepared->checks_as_written = std::none_of(options.overrides.begin(), options.overrides.end(), GivesChecks);
    prepared->changes = std::move(changes);
    prepared->notes.push_back(
        fmt::format("changed by --set: {}; {}stated limits belong to the scenario as written",
                    prepared->changes.empty() ? "nothing" : fmt::format("{}", fmt::join(prepared->changes, ", ")),
                    std::filesystem::exists(prepared->golden.trace) ? "the golden trace and " : ""));
  }
  return diagnostics.error_count() == before ? std::move(prepared) : nullptr;
}

}  // namespace dynoproof
