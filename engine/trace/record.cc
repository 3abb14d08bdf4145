#include "trace/record.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <utility>

#include "base/text_safety.h"
#include "trace/foreign_time.h"

namespace dynoproof::trace {

std::optional<std::size_t> Record::Find(std::string_view name) const {
  auto found = std::find_if(columns.begin(), columns.end(), [&](const Column& c) { return c.name == name; });
  if (found == columns.end() && !name.empty()) {
    found = std::find_if(columns.begin(), columns.end(), [&](const Column& c) { return c.heading == name; });
  }
  if (found == columns.end()) return {};
  return static_cast<std::size_t>(found - columns.begin());
}

std::vector<std::string> Record::Names() const {
  std::vector<std::string> names;
  for (const Column& column : columns) names.push_back(column.name);
  return names;
}

std::vector<std::string> Record::DescribeNonFinite() const {
  std::vector<std::string> sentences;
  for (const NonFinite& entry : non_finite) {
    const Column& column = columns[entry.column];
    const std::string place =
        entry.first_line > 0 ? fmt::format("line {}", entry.first_line) : fmt::format("row {}", entry.first_row);
    sentences.push_back(fmt::format("column \"{}\": {} of {} values {} empty or not finite, the first at {}",
                                    column.name, entry.count, column.values.size(), entry.count == 1 ? "is" : "are",
                                    place));
  }
  return sentences;
}

bool IsTimeName(std::string_view name) { return name == "t" || name == "time"; }

namespace {

/// The column of time stamps by a stranger's name. Of several it is the one that does not fall; a note says that a map has
/// to tell where that does not decide.
std::optional<std::size_t> ForeignTimeOf(Record& record) {
  std::vector<std::size_t> named, rising;
  for (std::size_t i = 0; i < record.columns.size(); ++i) {
    const std::vector<double>& values = record.columns[i].values;
    if (!ForeignTime(record.columns[i].name)) continue;
    named.push_back(i);
    const bool falls = std::adjacent_find(values.begin(), values.end(), std::greater<>()) != values.end();
    if (!falls && !values.empty() && values.front() != values.back()) rising.push_back(i);
  }
  const std::vector<std::size_t>& candidates = named.size() > 1 ? rising : named;
  if (candidates.empty()) return {};
  if (candidates.size() > 1) {
    record.notes.push_back(fmt::format("columns \"{}\" and \"{}\" could both be the time: a map has to say which",
                                       record.columns[candidates[0]].name, record.columns[candidates[1]].name));
    return {};
  }
  Column& time = record.columns[candidates[0]];
  if (time.unit.empty()) time.unit = ForeignTime(time.name)->unit;
  return candidates[0];
}

}  // namespace

void FinishRecord(Record& record) {
  const auto mend = [](std::string& text) { text = WithoutControls(ToUtf8(text)); };
  for (Column& column : record.columns) {
    mend(column.name);
    mend(column.unit);
    mend(column.heading);
  }
  for (auto& [name, why] : record.left_out) mend(name), mend(why);
  for (std::string& note : record.notes) note = AsMessage(note);
  for (std::size_t i = 0; i < record.columns.size(); ++i) {
    if (!IsTimeName(record.columns[i].name)) continue;
    if (!record.time) {
      record.time = i;
    } else if (*record.time != i) {
      record.notes.push_back(fmt::format("columns \"{}\" and \"{}\" could both be the time: the first is taken",
                                         record.columns[*record.time].name, record.columns[i].name));
    }
  }
  if (!record.time) record.time = ForeignTimeOf(record);
  for (std::size_t i = 0; i < record.columns.size(); ++i) {
    Column& column = record.columns[i];
    if (record.time && i != *record.time && !column.time &&
        column.values.size() == record.columns[*record.time].values.size() &&
        std::none_of(record.columns.begin(), record.columns.end(), [&](const Column& c) { return c.time == i; })) {
      column.time = record.time;
    }
    const auto is_bad = [](double value) { return !std::isfinite(value); };
    const auto first = std::find_if(column.values.begin(), column.values.end(), is_bad);
    if (first == column.values.end()) continue;
    const auto known = std::find_if(record.non_finite.begin(), record.non_finite.end(),
                                    [&](const NonFinite& entry) { return entry.column == i; });
    NonFinite& entry = known != record.non_finite.end() ? *known : record.non_finite.emplace_back();
    entry.column = i;
    entry.count = static_cast<std::size_t>(std::count_if(first, column.values.end(), is_bad));
    entry.first_row = static_cast<std::size_t>(first - column.values.begin());
  }
}

Record ToRecord(const Trace& trace, std::string source) {
  Record record;
  record.source = std::move(source);
  record.columns.push_back({.name = "time", .unit = "s", .values = trace.time, .time = {}});
  for (std::size_t k = 0; k < trace.other_times.size(); ++k) {
    record.columns.push_back(
        {.name = fmt::format("time_{}", k + 1), .unit = "s", .values = trace.other_times[k], .time = {}});
  }
  for (const Signal& signal : trace.signals) {
    // The time bases are the first columns, in their order, so their numbers are the same.
    record.columns.push_back({.name = signal.name,
                              .unit = signal.unit,
                              .values = signal.values,
                              .time = signal.time_base,
                              .held = signal.interpolation == Interpolation::kHold});
  }
  record.time = 0;
  FinishRecord(record);
  return record;
}

}  // namespace dynoproof::trace
