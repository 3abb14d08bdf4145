#include "app/extension.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>

#include "app/measured.h"
#include "experiment/measured_record.h"

namespace dynoproof::app {
namespace {

Failure Usage(std::string message) { return {.message = std::move(message), .exit_code = kUsage}; }

bool SameFile(const std::string& a, const std::string& b) {
  std::error_code error;
  return std::filesystem::weakly_canonical(a, error) == std::filesystem::weakly_canonical(b, error);
}

}  // namespace

Result<std::optional<diagnosis::ExtensionGain>> EvidenceFor(const Prepared& prepared, const EvidenceRecords& records,
                                                            const Registry& registry, Diagnostics& diagnostics) {
  const std::optional<ExtensionSpec> extension = ReadExtension(prepared.plan, diagnostics);
  if (!extension && records.empty()) return std::optional<diagnosis::ExtensionGain>();
  if (!extension)
    return Usage("--holdout, --record and --map are for scenarios with [extension]; this one extends no other");
  if (records.holdout.empty())
    return Usage(fmt::format(
        "the scenario extends {}: show what it gains on a record that took no part in the diagnosis, --holdout FILE, "
        "and that no other recorded experiment becomes worse, --record FILE each",
        extension->of));
  const std::string hash = HashOf(records.holdout);
  if (!hash.empty() && std::find(extension->data.begin(), extension->data.end(), hash) != extension->data.end())
    return Usage(
        fmt::format("{} is what the extension was found in: a gain on it says nothing; take a record that took "
                    "no part in the diagnosis",
                    records.holdout));
  const std::optional<MeasuredCase> nominal = LoadMeasured(extension->of, records.others, records.maps,
                                                           {records.holdout}, extension->set, registry, diagnostics);
  if (!nominal) return Usage(fmt::format("there is nothing to hold {} against", prepared.plan.id));
  for (const std::string& fault : {nominal->own_fault, prepared.record_fault}) {
    if (!fault.empty()) return Usage("the [record] of a scenario cannot be compared: " + fault);
  }
  std::vector<MappedRecord> others = nominal->data;
  if (nominal->own != nullptr) others.push_back(*nominal->own);
  const bool inherited =
      nominal->own != nullptr && prepared.data != nullptr && SameFile(nominal->own->file, prepared.data->file);
  if (prepared.data != nullptr && !inherited) others.push_back(*prepared.data);
  Result<diagnosis::ExtensionGain> evidence =
      diagnosis::WeighExtension(nominal->plan, prepared.plan, nominal->holdout.front(), others, registry);
  if (!evidence.ok()) return evidence.failure();
  return std::optional(*std::move(evidence));
}

}  // namespace dynoproof::app
