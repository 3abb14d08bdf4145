// Names that strangers give to the column of time stamps.
#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace dynoproof::trace {

/// What a name of IsTimeName() is to us, "Time", "time_s", "Zeit", "Timestamp", "X_Value", ... are to others. A column of
/// such a name holds the time stamps where none is called `t` or `time`.
struct ForeignTimeName {
  std::string unit;  // the one that the name ends with, "ms" of "time_ms"; "" where it names none
};

/// Nothing for any other name, and for those of IsTimeName().
std::optional<ForeignTimeName> ForeignTime(std::string_view name);

/// The unit of time that a name ends with, "us" of "stamp_us"; "" where it ends with none.
std::string TimeUnitOf(std::string_view name);

}  // namespace dynoproof::trace
