#include "tests/fuzz/target.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <set>

#include "base/text_safety.h"
#include "tests/support/temp_dir.h"

namespace dynoproof::fuzz {

void Require(bool held, std::string_view what) {
  if (held) return;
  std::fprintf(stderr, "fuzz: %.*s\n", static_cast<int>(what.size()), what.data());
  std::abort();
}

std::filesystem::path InputFile(std::string_view name, const std::uint8_t* data, std::size_t size) {
  static const test::TempDir folder;
  return folder.Write(name, {reinterpret_cast<const char*>(data), size});
}

void CheckMessage(const std::string& text) {
  Require(IsUtf8(text), "a message is not UTF-8");
  Require(WithoutControls(text, "\n\t") == text, "a message has control characters");
}

void CheckFailure(const Failure& failure) {
  Require(!failure.message.empty(), "a failure says nothing");
  Require(failure.exit_code == 2, "a bad file is not told as one: " + failure.message);
  CheckMessage(failure.ToString());
}

void CheckDiagnostics(const Diagnostics& diagnostics, bool read) {
  Require(read || diagnostics.has_errors(), "a file gave nothing, and no fault says why");
  CheckMessage(diagnostics.Format());
}

void CheckRecord(const Result<trace::Record>& record) {
  if (!record.ok()) return CheckFailure(record.failure());
  Require(!record->columns.empty(), "a record has no column");
  std::set<std::size_t> told;
  for (const trace::NonFinite& entry : record->non_finite) {
    Require(entry.column < record->columns.size() && told.insert(entry.column).second, "a column is told twice");
    const auto& values = record->columns[entry.column].values;
    const auto bad = [](double value) { return !std::isfinite(value); };
    Require(static_cast<std::size_t>(std::count_if(values.begin(), values.end(), bad)) == entry.count,
            "numbers that are none are miscounted");
    Require(entry.first_row < values.size() && bad(values[entry.first_row]), "the first of them is elsewhere");
  }
  for (std::size_t k = 0; k < record->columns.size(); ++k) {
    const trace::Column& column = record->columns[k];
    const auto finite = [](double value) { return std::isfinite(value); };
    Require(told.contains(k) || std::all_of(column.values.begin(), column.values.end(), finite),
            "a number that is none is passed over in silence");
    if (!column.time) continue;
    Require(*column.time < record->columns.size(), "stamps that do not exist");
    Require(record->columns[*column.time].values.size() == column.values.size(), "not as many stamps as values");
  }
  for (const std::string& note : record->notes) CheckMessage(note);
}

}  // namespace dynoproof::fuzz
