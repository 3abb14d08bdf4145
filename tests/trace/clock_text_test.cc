// Stamps as a clock shows them.
#include "trace/clock_text.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/trace/parse_csv.h"

namespace dynoproof::trace {
namespace {

double Of(const char* text) { return ClockReader().Read(text).value_or(NAN); }

TEST(ClockText, IsReadInTheFormsThatLoggersWrite) {
  for (const char* text :
       {"10:00:00.002", "2026-03-01T10:00:00.002", "2026-03-01 10:00:00,002", "01.03.2026 10:00:00,002",
        "2026/03/01 10:00:00.002", "3/1/2026 10:00:00.002 AM", "13/3/2026 10:00:00.002", "2026-03-01T10:00:00.002Z",
        "2026-03-01T11:00:00.002+01:00", "2026-03-01T08:30:00.002-0130"})
    EXPECT_NEAR(Of(text), 36000.002, 1e-9) << text;
  EXPECT_DOUBLE_EQ(Of("12:00:01 AM"), 1.0);
  EXPECT_DOUBLE_EQ(Of("1:00:00 PM"), 46800.0);
  EXPECT_DOUBLE_EQ(Of("02:03.5"), 123.5) << "minutes and seconds, where there are decimals";
}

TEST(ClockText, OfWordsIsNone) {
  for (const char* text :
       {"", ":", "on", "10:00", "25:00:00", "10:61:00", "10:00:61", "2026-13-01T10:00:00", "2026-02-30 10:00:00",
        "40.03.2026 10:00:00", "2026-03-01", "10:00:00.", "10:00:00 XM", "13:00:00 PM", "10:00:00+99:00", "1:2:3:4",
        "a 10:00:00", "31/31/2026 10:00:00", "ratio 1:2"})
    EXPECT_TRUE(std::isnan(Of(text))) << text;
}

TEST(ClockText, GoesOnOverMidnight) {
  ClockReader clock, date, slashed;
  EXPECT_DOUBLE_EQ(*clock.Read("23:59:59.5"), 86399.5);
  EXPECT_DOUBLE_EQ(*clock.Read("00:00:00.5"), 86400.5);
  EXPECT_DOUBLE_EQ(*clock.Read("00:00:00.6"), 86400.6);
  EXPECT_DOUBLE_EQ(*date.Read("2026-02-28T23:59:59.5"), 86399.5);
  EXPECT_DOUBLE_EQ(*date.Read("2026-03-01T00:00:00.5"), 86400.5);
  EXPECT_DOUBLE_EQ(*slashed.Read("1/3/2026 23:59:59.5"), 86399.5);
  EXPECT_DOUBLE_EQ(*slashed.Read("2/3/2026 00:00:00.5"), 86400.5);
}

TEST(ClockText, IsTheTimeOfARecord) {
  const Record record =
      test::Read("Timestamp;T [Nm]\n2026-03-01T10:00:00,000;1\n2026-03-01T10:00:00,002;2\n2026-03-01T10:00:00,006;4\n");
  ASSERT_TRUE(record.time.has_value());
  const Column& time = record.columns[*record.time];
  EXPECT_EQ(time.unit, "s");
  EXPECT_NEAR(time.values[2] - time.values[0], 0.006, 1e-9);
  EXPECT_EQ(record.columns.size(), 2U);
}

TEST(ClockText, AmongNumbersAndWordsIsNoValue) {
  const Record numbers = test::Read("t,a\n0,10:00:00\n1,5\n2,6\n3,7\n");
  ASSERT_EQ(numbers.columns.size(), 2U);
  EXPECT_TRUE(std::isnan(numbers.columns[1].values[0])) << "no 36000 among other numbers";
  EXPECT_DOUBLE_EQ(numbers.columns[1].values[1], 5.0);
  const Record words = test::Read("t,a\n0,10:00:00\n1,off\n2,10:00:02\n");
  EXPECT_EQ(words.columns.size(), 1U);
  const Record gap = test::Read("Uhrzeit,a\n10:00:00.0,1\n,2\n10:00:00.2,3\n");
  EXPECT_TRUE(std::isnan(gap.columns[0].values[1]));
}

}  // namespace
}  // namespace dynoproof::trace
