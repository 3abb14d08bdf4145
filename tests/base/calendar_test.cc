#include "base/calendar.h"

#include <gtest/gtest.h>

namespace dynoproof {
namespace {

TEST(Calendar, TakesADayAsItIsWritten) {
  for (const char* day : {"2026-01-31", "1999-12-01", "2024-02-29"}) EXPECT_TRUE(IsDay(day)) << day;
  for (const char* other : {"", "2026-1-31", "2026-13-01", "2026-00-10", "2026-01-00", "2026-01-32", "31.01.2026",
                            "2026-01-31 ", "2026-01-3x", "2026/01/31", "12026-01-31"})
    EXPECT_FALSE(IsDay(other)) << other;
}

TEST(Calendar, TakesASecondInUtcAlone) {
  for (const char* second : {"2026-01-31T02:00:00Z", "2026-12-31T23:59:59Z"})
    EXPECT_TRUE(IsSecondOfDay(second)) << second;
  for (const char* other : {"2026-01-31", "2026-01-31T24:00:00Z", "2026-01-31T02:60:00Z", "2026-01-31T02:00:60Z",
                            "2026-01-31T02:00:00", "2026-01-31T02:00:00+01:00", "2026-13-31T02:00:00Z"})
    EXPECT_FALSE(IsSecondOfDay(other)) << other;
}

}  // namespace
}  // namespace dynoproof
