#include "trace/record.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "base/text_safety.h"

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
    record.columns.push_back(
        {.name = signal.name, .unit = signal.unit, .values = signal.values, .time = signal.time_base});
  }
  record.time = 0;
  FinishRecord(record);
  return record;
}

}  // namespace dynoproof::trace
