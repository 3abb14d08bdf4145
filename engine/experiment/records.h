// Measured data for a scenario: a file, a map that says which column is which signal, and the result in SI units.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "base/diagnostics.h"
#include "base/status.h"
#include "model/registry.h"
#include "trace/record.h"

namespace dynoproof {

/// A record with names and units of a scenario.
struct MappedRecord {
  std::string file;
  std::map<std::string, Series> inputs, outputs;  // by name of [input.NAME], [output.NAME]; SI
  std::vector<std::string> notes;                 // what a reader should know
  double end_s = 0.0;                             // time of the last sample; the first is at 0
};

/// Fewer samples of an output say nothing about a simulation.
inline constexpr std::size_t kFewestSamples = 100;
/// "3 samples are too few ..."; empty where there are enough.
std::string TooFew(std::size_t samples);

/// Reads CSV, HDF5 or MAT by the file's ending.
Result<trace::Record> ReadRecord(const std::string& file);

/// What a record may be mapped to: name and unit; an empty unit takes the column as it is.
struct SignalName {
  std::string name, unit;
};

/// Applies a map file (contract, "Measured data"); without one (empty) columns are taken by name. Reported as errors: a
/// column or signal that does not exist, a unit of another quantity, values that are not finite, time that does not
/// rise, a record in which nothing matches.
std::optional<MappedRecord> MapRecord(const trace::Record& record, const std::string& map_file,
                                      const std::vector<SignalName>& inputs, const std::vector<SignalName>& outputs,
                                      Diagnostics& diagnostics);

}  // namespace dynoproof
