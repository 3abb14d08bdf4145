// A record: what a measurement file holds, column by column, before anybody has said what the columns mean. Columns may
// differ in length and time base, as HDF5 and MAT files have it; text files give equal lengths.
#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "base/status.h"
#include "trace/trace.h"

namespace dynoproof::trace {

/// One measured quantity as it stands in the file: no unit conversion, no sign.
struct Column {
  std::string name;
  std::string unit = {};                 // as written; "" if the file names none
  std::vector<double> values = {};       // NaN where the file has NaN or an empty cell, see Record::non_finite
  std::optional<std::size_t> time = {};  // the column of its time stamps, if the file has one; none for a time column
  std::string heading = {};              // what stands above it, where name and unit were told apart: "time [ms]"
  bool held = false;                     // the file says that it holds each sample until the next
};

/// Where a column is not finite. Row numbers start at 0, line numbers at 1; `first_line` is 0 for binary files.
struct NonFinite {
  std::size_t column = 0;
  std::size_t count = 0;
  std::size_t first_row = 0;
  std::size_t first_line = 0;
};

struct Record {
  std::string source;  // the file it was read from
  std::vector<Column> columns;
  std::optional<std::size_t> time;    // the column `t` or `time`, if there is one
  std::vector<NonFinite> non_finite;  // at most one entry a column; empty means every value is finite
  std::vector<std::string> notes;     // what a reader should know, one sentence each
  std::vector<std::pair<std::string, std::string>> left_out =
      {};  // what is no column of numbers: name, "is a cell ..."

  /// The column of this name, or else of this heading, or nothing.
  std::optional<std::size_t> Find(std::string_view name) const;
  std::vector<std::string> Names() const;
  /// "column "x": 3 values are not finite, the first at line 17", one for each entry of `non_finite`.
  std::vector<std::string> DescribeNonFinite() const;
};

/// Whether a column of this name holds the time stamps: `t` or `time`, in this case (`T` is a torque).
bool IsTimeName(std::string_view name);

/// Makes the first column that IsTimeName() the time column of the record and of every column of its length that has
/// none; fills `non_finite`, keeping the line numbers of entries that are there already. Names, units and notes become
/// UTF-8 without controls, whatever bytes the file has there. Readers call it last.
void FinishRecord(Record& record);

/// A trace seen as a record: column `time`, `time_1`, ..., and one column a signal.
Record ToRecord(const Trace& trace, std::string source);

}  // namespace dynoproof::trace
