// Days and seconds as people and JSON write them.
#pragma once

#include <string_view>

namespace dynoproof {

/// Whether a text names a day, 2026-01-31. Each month may have 31 days here.
bool IsDay(std::string_view text);
/// Whether it names a second in UTC, 2026-01-31T02:00:00Z.
bool IsSecondOfDay(std::string_view text);

}  // namespace dynoproof
