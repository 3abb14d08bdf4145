// [record]: a measurement that a scenario is held against, and the gaps that are accepted for a while.
#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "experiment/checks.h"
#include "experiment/records.h"
#include "model/params.h"
#include "model/plan.h"
#include "score/verdict.h"
#include "sim/simulate.h"

namespace dynoproof {

/// [record.accepted.OUTPUT]: a known gap. Until that day the output is held against this limit instead of its own.
struct AcceptedGap {
  double nrmse = 0.0;
  std::string reason, until;
  void Visit(auto& v) {
    v.Required("nrmse", nrmse, Positive("1"), "limit as long as the gap is accepted");
    v.Required("reason", reason, Any(), "why it is accepted");
    v.Required("until", until, Any(), "last day, \"2026-12-31\"; from then on the output's own limit holds again");
  }
  void Check(Faults& faults) const;
};

struct RecordSettings {
  std::string file, hash, map;
  std::vector<std::pair<std::string, double>> nrmse;
  std::vector<std::pair<std::string, AcceptedGap>> accepted;
  void Visit(auto& v) {
    v.Optional("file", file, Any(), "the record, beside the scenario: drives its inputs whenever it runs");
    v.Optional("hash", hash, Any(), "SHA-256 of the file, hexadecimal");
    v.Optional("map", map, Any(), "which column is which signal, beside the scenario");
    v.Optional("nrmse", nrmse, Positive("1"), "largest NRMSE by output");
    v.Optional("accepted", accepted, Any(), "known gaps by output");
  }
};

/// SHA-256 of a file, hexadecimal; empty when it cannot be read, or is no file but a pipe, a device or a folder.
std::string HashOf(const std::string& file);

/// The plan's [record]; faults (outputs that do not exist, no hash) become diagnostics.
std::optional<RecordSettings> ReadRecordSettings(const Plan& plan, const Rig& rig, Diagnostics& diagnostics);

/// Reads and maps the record of a scenario in `folder`. Fails when it is missing, has another hash, cannot be mapped.
Result<MappedRecord> OpenRecord(const RecordSettings& settings, const std::string& folder, const Rig& rig);

/// The rig's names and units, for MapRecord().
std::vector<SignalName> InputNames(const Rig& rig);
std::vector<SignalName> OutputNames(const Rig& rig);

/// The outputs of a run against a record, each at the record's own time stamps; figures OUTPUT.nrmse. An output that is
/// limited but not in the record fails. `today` decides on accepted gaps ("2026-01-31").
std::vector<score::Check> CompareWithRecord(const Rig& rig, const Samples& samples, const MappedRecord& data,
                                            const RecordSettings& settings, const std::string& today, Figures& figures);

/// This day by the clock, UTC.
std::string Today();

}  // namespace dynoproof
