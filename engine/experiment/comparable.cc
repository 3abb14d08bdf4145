#include "experiment/comparable.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <filesystem>
#include <limits>
#include <map>

#include "base/units.h"
#include "experiment/records.h"
#include "trace/time_base.h"
#include "trace/trace_io.h"

namespace dynoproof {
namespace {

bool IsHdf5(const std::string& file) {
  std::string ending = std::filesystem::path(file).extension().string();
  std::transform(ending.begin(), ending.end(), ending.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return ending != ".csv" && ending != ".txt" && ending != ".mat" && ending != ".lvm";
}

Failure Bad(std::string message, const std::string& file) {
  return {.message = std::move(message), .signal = file, .exit_code = 2};
}

/// The time column's numbers in seconds.
Result<std::vector<double>> Seconds(const trace::Column& column, const std::string& file) {
  std::vector<double> time = column.values;
  if (column.unit.empty()) return time;
  const std::optional<Unit> unit = ParseUnit(column.unit);
  if (!unit || !SameQuantity(*unit, *ParseUnit("s")))
    return Bad(fmt::format("the time \"{}\" is in \"{}\", which is no unit of time", column.name, column.unit), file);
  for (double& stamp : time) stamp *= unit->factor;
  return time;
}

Result<trace::Trace> TraceOf(const trace::Record& record, const std::string& file) {
  trace::Trace trace;
  std::map<std::size_t, std::size_t> bases;  // the number of each time column
  for (std::size_t i = 0; i < record.columns.size(); ++i) {
    const trace::Column& column = record.columns[i];
    const bool is_time = record.time == i || std::any_of(record.columns.begin(), record.columns.end(),
                                                         [i](const trace::Column& other) { return other.time == i; });
    if (is_time) continue;
    if (!column.time)
      return Bad(fmt::format("column \"{}\" has no time stamps; a column named \"time\" holds them", column.name),
                 file);
    const auto [base, is_new] = bases.emplace(*column.time, bases.size());
    if (is_new) {
      Result<std::vector<double>> time = Seconds(record.columns[*column.time], file);
      if (!time.ok()) return time.failure();
      (base->second == 0 ? trace.time : trace.other_times.emplace_back()) = *std::move(time);
    }
    trace::Signal& signal = trace.signals.emplace_back();
    signal.name = column.name;
    signal.unit = column.unit;
    signal.values = column.values;
    signal.time_base = base->second;
    signal.nominal_known = false;
  }
  if (trace.signals.empty()) return Bad("has no column with time stamps", file);
  return trace;
}

/// Sets rows at one instant the next double apart; how many instants there are.
Result<std::size_t> SetApart(std::vector<double>& time, const std::string& file) {
  if (const std::size_t bad = trace::FirstFaultOf(time); bad < time.size()) {
    return Bad(fmt::format("the time {} at row {} ({})", std::isfinite(time[bad]) ? "falls" : "is not a number", bad,
                           time[bad]),
               file);
  }
  std::size_t events = 0, row_of_event = 0;
  double instant = time.empty() ? 0.0 : time[0];
  for (std::size_t i = 1; i < time.size(); ++i) {
    if (time[i] != instant) {
      instant = time[i];
      row_of_event = 0;
      continue;
    }
    if (++row_of_event == 1) ++events;
    time[i] = std::nextafter(time[i - 1], std::numeric_limits<double>::infinity());
  }
  return events;
}

}  // namespace

Result<trace::Trace> ReadComparable(const std::string& file, std::vector<std::string>& notes) {
  Result<trace::Trace> trace = Failure{};
  if (IsHdf5(file)) {
    trace = trace::ReadTraceUnchecked(file);
  } else {
    const Result<trace::Record> record = ReadRecord(file);
    if (!record.ok()) return record.failure();
    for (const std::string& note : record->notes) notes.push_back(file + ": " + note);
    trace = TraceOf(*record, file);
  }
  if (!trace.ok()) return trace;
  std::size_t events = 0;
  const auto set_apart = [&](std::vector<double>& time) -> Status {
    const Result<std::size_t> found = SetApart(time, file);
    if (!found.ok()) return found.failure();
    events = std::max(events, *found);
    return {};
  };
  if (Status failed = set_apart(trace->time)) return *failed;
  for (std::vector<double>& time : trace->other_times) {
    if (Status failed = set_apart(time)) return *failed;
  }
  if (events > 0)
    notes.push_back(
        fmt::format("{}: {} instant{} of several rows, each taken as a jump from the first to the last of them", file,
                    events, events == 1 ? "" : "s"));
  if (const std::vector<std::string> problems = trace::Validate(*trace); !problems.empty())
    return Bad(fmt::format("{}", fmt::join(problems.begin(),
                                           problems.begin() + std::min<std::size_t>(20, problems.size()), "\n")),
               file);
  return trace;
}

}  // namespace dynoproof
