// Time stamps that are written as a clock shows them: "2026-03-01T10:00:00.002", "01.03.2026 10:00:00,002", "10:00:00.002".
#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace dynoproof::trace {

/// Reads the cells of one column, row by row. A stamp is seconds from the midnight before the first one: so they keep digits
/// that seconds of an epoch have not. A clock without a date that falls back by more than half a day has passed midnight.
///
/// A date is year-month-day (also with "/"), day.month.year, or two numbers and a year parted by "/". Of the last nobody knows
/// which is the day: where that text changes, it is taken as the next day. The time is h:mm:ss with decimals or none, behind it
/// AM or PM, "Z" or an offset, which is subtracted; mm:ss with decimals is read, h:mm and a date alone are not.
class ClockReader {
 public:
  /// Seconds; nothing where the text is no such stamp.
  std::optional<double> Read(std::string_view text);

 private:
  std::optional<long> DayOf(std::string_view date);

  std::optional<long> first_day_;
  std::string slashed_;         // the last date of two numbers and a year
  long slashed_day_ = 0;        // counts its changes
  std::optional<double> last_;  // of a clock without a date
  double midnights_s_ = 0.0;
};

}  // namespace dynoproof::trace
