// Measured data for a scenario: a file, a map that says which column is which signal, and the result in SI units and on
// one clock, which begins with the inputs.
#pragma once

#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "base/diagnostics.h"
#include "base/status.h"
#include "experiment/record_map.h"
#include "model/registry.h"
#include "trace/record.h"

namespace dynoproof {

/// A record with names and units of a scenario.
struct MappedRecord {
  std::string file;
  std::string time_column, time_unit;  // of the stamps: its name, and the unit in which they were read
  /// By name of [input.NAME], [output.NAME]; SI. Instants [s] from the first one at which all inputs are known; inputs
  /// may have samples before it. Of a uniform base they are multiples of its step.
  std::map<std::string, Series> inputs, outputs;
  std::map<std::string, double> step_s;        // of channels with a uniform base, by name
  std::map<std::string, std::string> between;  // of inputs, where that is known: as a map says it
  std::set<std::string> guessed;               // inputs of which nobody says it: `between` is what fits best
  std::vector<std::string> notes;              // what a reader should know
  double end_s = 0.0;                          // time of the last sample
  /// To which the stamps leave open what the numbers depend on: the step, as a share of it, and the instants of an output
  /// beside those of the inputs [s], by name.
  double step_doubt = 0.0;
  std::map<std::string, double> shift_doubt_s;
  bool in_motion = false;  // begins otherwise than the scenario does: its start is to be estimated along
  double period_s = 0.0;   // of the run onto whose clock it was brought (drive_by_record.h); 0: it was not yet
};

/// Fewer samples of an output say nothing about a simulation: of 30 the spread is known to an eighth.
inline constexpr std::size_t kFewestSamples = 30;
/// "3 samples are too few ..."; empty where there are enough.
std::string TooFew(std::size_t samples);

/// Reads CSV, HDF5 or MAT by the file's ending, as a map asks for it.
Result<trace::Record> ReadRecord(const std::string& file, const RecordMap& map = {});

/// What a record may be mapped to: name and unit; an empty unit takes the column as it is.
struct SignalName {
  std::string name, unit;
  double known_from_s = 0.0;  // samples before are left out (Rig::KnownFrom)
};

/// Applies a map (contract, "Measured data"); without one (empty) columns are taken by name. Reported as errors: a
/// column or signal that does not exist, a unit of another quantity, values that are not finite, time that falls, a
/// record in which nothing matches, channels that have no time in common.
std::optional<MappedRecord> MapRecord(const trace::Record& record, const RecordMap& map,
                                      const std::vector<SignalName>& inputs, const std::vector<SignalName>& outputs,
                                      Diagnostics& diagnostics);

/// Reads a map file and the record, and applies the one to the other; every fault becomes a diagnostic.
std::optional<MappedRecord> OpenRecord(const std::string& file, const std::string& map_file,
                                       const std::vector<SignalName>& inputs, const std::vector<SignalName>& outputs,
                                       Diagnostics& diagnostics);

}  // namespace dynoproof
