#include "trace/foreign_time.h"

#include <algorithm>
#include <array>
#include <cctype>

#include "base/units.h"
#include "trace/record.h"

namespace dynoproof::trace {

namespace {

/// Letters in small, one blank for all that parts words: "Time_Stamp (ms)" is "time stamp ms".
std::string Plain(std::string_view name) {
  std::string plain;
  for (const char c : name) {
    const auto byte = static_cast<unsigned char>(c);
    if (std::isalnum(byte) != 0 || byte > 127)
      plain += static_cast<char>(std::tolower(byte));
    else if (!plain.empty() && plain.back() != ' ')
      plain += ' ';
  }
  if (plain.ends_with(' ')) plain.pop_back();
  return plain;
}

}  // namespace

std::string TimeUnitOf(std::string_view name) {
  const std::string plain = Plain(name);
  const std::size_t at = plain.rfind(' ');
  if (at == std::string::npos) return "";
  const std::optional<Unit> unit = ParseUnit(plain.substr(at + 1));
  return unit && SameQuantity(*unit, *ParseUnit("s")) ? plain.substr(at + 1) : "";
}

std::optional<ForeignTimeName> ForeignTime(std::string_view name) {
  if (name.empty() || IsTimeName(name)) return {};
  ForeignTimeName foreign{TimeUnitOf(name)};
  std::string plain = Plain(name);
  if (!foreign.unit.empty()) plain.resize(plain.size() - foreign.unit.size() - 1);
  if (plain.ends_with(" in")) plain.resize(plain.size() - 3);  // "Zeit in ms"
  static constexpr std::array<std::string_view, 26> kNames = {
      "t",         "time",          "times",     "timestamp",     "time stamp",   "timestamps", "timeaxis",
      "time axis", "elapsed",       "zeit",      "zeitstempel",   "temps",        "tiempo",     "tempo",
      "x value",   "abs time",      "rel time",  "relative time", "elapsed time", "uhrzeit",    "datetime",
      "date time", "datum uhrzeit", "zeitpunkt", "clock",         "time of day"};
  // T_s is a torque, or a temperature.
  if ((plain == "t" && name.front() == 'T') || std::find(kNames.begin(), kNames.end(), plain) == kNames.end())
    return {};
  return foreign;
}

}  // namespace dynoproof::trace
