#include "trace/clock_text.h"

#include <array>
#include <charconv>
#include <chrono>

namespace dynoproof::trace {
namespace {

constexpr double kDay_s = 86400.0;

/// A number at the beginning, which it leaves; `most` digits. Nothing where there is none.
std::optional<long> TakeNumber(std::string_view& text, std::size_t most) {
  std::size_t digits = 0;
  while (digits < text.size() && digits < most && text[digits] >= '0' && text[digits] <= '9') ++digits;
  long number = 0;
  if (digits == 0 || std::from_chars(text.data(), text.data() + digits, number).ec != std::errc()) return {};
  text.remove_prefix(digits);
  return number;
}

bool Take(std::string_view& text, std::string_view one_of) {
  if (text.empty() || one_of.find(text.front()) == std::string_view::npos) return false;
  text.remove_prefix(1);
  return true;
}

/// Decimals behind a mark, as a share of one.
std::optional<double> TakeDecimals(std::string_view& text) {
  if (!Take(text, ".,")) return {};
  double value = 0.0;
  std::string digits = "0.";
  while (!text.empty() && text.front() >= '0' && text.front() <= '9') digits += text.front(), text.remove_prefix(1);
  if (digits.size() == 2) return {};
  std::from_chars(digits.data(), digits.data() + digits.size(), value);
  return value;
}

/// "Z", "+01:00" or "-0530": seconds to be subtracted.
std::optional<double> ZoneOf(std::string_view text) {
  if (text.empty() || text == "Z" || text == "z") return 0.0;
  const double sign = text.front() == '-' ? -1.0 : 1.0;
  if (!Take(text, "+-")) return {};
  const std::optional<long> hours = TakeNumber(text, 2);
  Take(text, ":");
  const std::optional<long> minutes = text.empty() ? std::optional<long>(0) : TakeNumber(text, 2);
  if (!hours || !minutes || !text.empty() || *hours > 14 || *minutes > 59) return {};
  return sign * (3600.0 * static_cast<double>(*hours) + 60.0 * static_cast<double>(*minutes));
}

/// Seconds of a clock, and what an offset adds.
std::optional<double> ClockOf(std::string_view text) {
  const std::optional<long> first = TakeNumber(text, 2);
  if (!first || !Take(text, ":")) return {};
  const std::optional<long> second = TakeNumber(text, 2);
  if (!second || *second > 59) return {};
  if (const std::string_view before = text; const std::optional<double> decimals = TakeDecimals(text)) {
    if (*first > 59 || !text.empty() || before == text) return {};
    return 60.0 * static_cast<double>(*first) + static_cast<double>(*second) + *decimals;
  }
  if (!Take(text, ":")) return {};
  const std::optional<long> seconds = TakeNumber(text, 2);
  if (!seconds || *seconds > 60 || *first > 24) return {};
  const bool marked = text.starts_with('.') || text.starts_with(',');
  const std::optional<double> decimals = TakeDecimals(text);
  if (marked && !decimals) return {};
  double hours = static_cast<double>(*first);
  while (Take(text, " ")) {
  }
  for (const auto& [word, half_day] : {std::pair{"AM", 0.0}, {"am", 0.0}, {"PM", 12.0}, {"pm", 12.0}}) {
    if (!text.starts_with(word)) continue;
    if (*first < 1 || *first > 12) return {};
    hours = half_day + static_cast<double>(*first % 12);
    text.remove_prefix(2);
    break;
  }
  const std::optional<double> zone = ZoneOf(text);
  if (!zone) return {};
  return 3600.0 * hours + 60.0 * static_cast<double>(*second) + static_cast<double>(*seconds) + decimals.value_or(0.0) -
         *zone;
}

std::optional<long> CivilDay(long year, long month, long day) {
  const std::chrono::year_month_day date{std::chrono::year(static_cast<int>(year)),
                                         std::chrono::month(static_cast<unsigned>(month)),
                                         std::chrono::day(static_cast<unsigned>(day))};
  if (!date.ok()) return {};
  return std::chrono::sys_days(date).time_since_epoch().count();
}

}  // namespace

std::optional<long> ClockReader::DayOf(std::string_view date) {
  const std::string_view whole = date;
  const std::optional<long> a = TakeNumber(date, 4);
  if (!a || date.empty()) return {};
  const char mark = date.front();
  if (!Take(date, "-./")) return {};
  const std::optional<long> b = TakeNumber(date, 2);
  if (!b || date.empty() || date.front() != mark) return {};
  date.remove_prefix(1);
  const std::optional<long> c = TakeNumber(date, 4);
  if (!c || !date.empty()) return {};
  constexpr long kYears = 1000;  // of four digits
  if (*a >= kYears) return mark == '.' ? std::nullopt : CivilDay(*a, *b, *c);
  if (*c < kYears) return {};
  if (mark == '.') return CivilDay(*c, *b, *a);
  if (mark == '-' || (!CivilDay(*c, *a, *b) && !CivilDay(*c, *b, *a))) return {};
  if (!slashed_.empty() && slashed_ != whole) ++slashed_day_;
  slashed_ = whole;
  return slashed_day_;
}

std::optional<double> ClockReader::Read(std::string_view text) {
  const std::size_t colon = text.find(':');
  if (colon == std::string_view::npos || text.size() > 40) return {};
  const std::size_t part = text.find_last_of("T ", colon);
  if (part == std::string_view::npos) {
    const std::optional<double> clock = ClockOf(text);
    if (!clock) return {};
    if (last_ && *clock < *last_ - 0.5 * kDay_s) midnights_s_ += kDay_s;
    last_ = clock;
    return *clock + midnights_s_;
  }
  std::string_view date = text.substr(0, part);
  while (date.ends_with(' ')) date.remove_suffix(1);
  const std::optional<double> clock = ClockOf(text.substr(part + 1));
  const std::optional<long> day = clock ? DayOf(date) : std::nullopt;
  if (!day) return {};
  if (!first_day_) first_day_ = day;
  return *clock + kDay_s * static_cast<double>(*day - *first_day_);
}

}  // namespace dynoproof::trace
