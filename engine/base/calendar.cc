#include "base/calendar.h"

#include <algorithm>

namespace dynoproof {
namespace {

/// Whether a text has digits where the shape has zeros, and is the shape elsewhere.
bool HasShape(std::string_view text, std::string_view shape) {
  return std::ranges::equal(
      text, shape, [](char own, char asked) { return asked == '0' ? own >= '0' && own <= '9' : own == asked; });
}

/// Two digits of a text at `begin` as a number.
int TwoDigits(std::string_view text, std::size_t begin) { return 10 * (text[begin] - '0') + (text[begin + 1] - '0'); }

}  // namespace

bool IsDay(std::string_view text) {
  if (!HasShape(text, "0000-00-00")) return false;
  const int month = TwoDigits(text, 5), day = TwoDigits(text, 8);
  return month >= 1 && month <= 12 && day >= 1 && day <= 31;
}

bool IsSecondOfDay(std::string_view text) {
  return HasShape(text, "0000-00-00T00:00:00Z") && IsDay(text.substr(0, 10)) && TwoDigits(text, 11) < 24 &&
         TwoDigits(text, 14) < 60 && TwoDigits(text, 17) < 60;
}

}  // namespace dynoproof
