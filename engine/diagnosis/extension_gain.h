// What an extended scenario has to show before it may become golden: that it foretells a record which took no part in
// making it better than the nominal scenario does, and no other record worse.
#pragma once

#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "diagnosis/gain.h"

namespace dynoproof::diagnosis {

/// What the extension gains on the nominal scenario in one record, by signal.
struct RecordGains {
  std::string file;
  bool holdout = false;
  std::map<std::string, SignalGain> gains;
};

struct ExtensionGain {
  std::vector<RecordGains> records;  // the hold-out first
  std::string lacking;               // why it is not enough; empty: it is
};

/// Why the gains do not speak for the extension; empty where they do: an interval of the hold-out lies above zero and
/// none of any record below. What is no number, or was not compared, speaks against it.
std::string Lacking(const std::vector<RecordGains>& records);

/// Predicts every record by both plans, effects applied, each from the plan's own start as a diagnosis predicts its
/// hold-out. Fails where a run breaks.
Result<ExtensionGain> WeighExtension(const Plan& nominal, const Plan& extended, const MappedRecord& holdout,
                                     const std::vector<MappedRecord>& others, const Registry& registry);

nlohmann::json ToJson(const ExtensionGain& extension);
/// Record, signal, NRMSE before and after, interval of the gain.
std::string ToTable(const ExtensionGain& extension);
/// What was gained on the hold-out, as one sentence.
std::string GainSentence(const ExtensionGain& extension);

}  // namespace dynoproof::diagnosis
