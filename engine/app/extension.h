// What `bless` asks of a scenario that a diagnosis has extended.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "base/diagnostics.h"
#include "base/status.h"
#include "diagnosis/extension_gain.h"
#include "experiment/prepare.h"

namespace dynoproof::app {

struct EvidenceRecords {
  std::string holdout;              // took no part in the diagnosis
  std::vector<std::string> others;  // recorded experiments that must not become worse
  std::vector<std::string> maps;    // one for all, or one each: those of `others`, then the hold-out's
  bool empty() const { return holdout.empty() && others.empty() && maps.empty(); }
};

/// What a scenario with [extension] gains on its nominal one in these records and in the [record] of either; nothing
/// for a scenario without. Fails where records are missing, are given in vain, or a run breaks; faults of the nominal
/// scenario and of the records go to `diagnostics` besides.
Result<std::optional<diagnosis::ExtensionGain>> EvidenceFor(const Prepared& prepared, const EvidenceRecords& records,
                                                            const Registry& registry, Diagnostics& diagnostics);

}  // namespace dynoproof::app
