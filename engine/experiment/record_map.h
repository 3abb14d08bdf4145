// A map file: which column of a record is which signal, on which clock, in which unit (`dynoproof describe map`).
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "base/diagnostics.h"
#include "model/params.h"
#include "model/value.h"

namespace dynoproof {

/// Where the instants of a channel, or of all of them, come from: a column of stamps, or a rate.
struct ClockMap {
  std::string column, unit;  // "": as the file has it
  double rate_hz = 0.0;      // instead of a column
  double start_s = 0.0;      // of the first row, with rate_hz; added to the stamps of a column
  SourceSpan where;
  bool given() const { return !column.empty() || rate_hz > 0.0; }
};

/// [input.NAME] or [output.NAME].
struct ChannelMap {
  std::string name;  // of the signal
  std::string column, unit, between;
  double gain = 1.0, offset = 0.0, sign = 1.0;
  bool missing = false, derivative = false;
  ClockMap clock;
  SourceSpan where;
};

struct RecordMap {
  std::string file;  // "": there is none, columns are taken by name
  ClockMap clock;
  std::size_t first = 0, last = static_cast<std::size_t>(-1);  // rows [first, last) of the file's own clock
  SourceSpan rows_where;
  int skip = 0;  // lines of a text file before its names
  std::vector<ChannelMap> inputs, outputs;

  /// The columns that it names, each once: of an HDF5 file the datasets to read.
  std::vector<std::string> Columns() const;
};

/// Reads a map file; every fault becomes a diagnostic, and then there is none. An empty name gives an empty map.
std::optional<RecordMap> ReadRecordMap(const std::string& file, Diagnostics& diagnostics);

/// The keys of a map file with what they mean, for `describe map`.
std::string DescribeRecordMap();

}  // namespace dynoproof
