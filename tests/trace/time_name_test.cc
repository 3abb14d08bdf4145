// Which column holds the time stamps, by the names that people and loggers give it.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <utility>
#include <vector>

#include "tests/trace/parse_csv.h"
#include "trace/csv.h"
#include "trace/foreign_time.h"

namespace dynoproof::trace {
namespace {

using test::Read;
using ::testing::Contains;
using ::testing::HasSubstr;

TEST(TimeName, StrangersAreKnownWithTheUnitThatTheyEndWith) {
  const std::vector<std::pair<std::string, std::string>> names = {
      {"Time", ""},         {"TIME", ""},
      {"time_s", "s"},      {"Time_ms", "ms"},
      {"t_us", "us"},       {"Zeit", ""},
      {"Zeit s", "s"},      {"Timestamp", ""},
      {"time stamp", ""},   {"TIMESTAMP_NS", "ns"},
      {"X_Value", ""},      {"timestamps", ""},
      {"Elapsed Time", ""}, {"time_\xC2\xB5s", "\xC2\xB5s"}};
  for (const auto& [name, unit] : names) {
    const std::optional<ForeignTimeName> foreign = ForeignTime(name);
    ASSERT_TRUE(foreign.has_value()) << name;
    EXPECT_EQ(foreign->unit, unit) << name;
    const Record record = Read(name + ",x\n0,5\n1,6\n2,7\n");
    ASSERT_EQ(record.time, 0u) << name;
    EXPECT_EQ(record.columns[0].unit, unit) << name;
    EXPECT_EQ(record.columns[1].time, 0u) << name;
  }
}

TEST(TimeName, QuantitiesAreNone) {
  for (const char* name : {"T", "T_s", "T s", "T_airgap", "torque", "t_oil", "time_constant", "x", "", "tau", "timer",
                           "T_ms", "rate", "time_kg"})
    EXPECT_FALSE(ForeignTime(name).has_value()) << name;
  EXPECT_EQ(Read("T_s,x\n0,5\n1,6\n2,7\n").time, std::nullopt);
}

TEST(TimeName, OnesOwnGoFirstAndTheFileSaysTheUnit) {
  EXPECT_EQ(Read("Timestamp,t,x\n5,0,1\n6,1,2\n7,2,3\n").time, 1u);
  EXPECT_EQ(Read("Time_ms [us],x\n0,5\n1,6\n2,7\n").columns[0].unit, "us");
}

TEST(TimeName, OfTwoTheOneThatRises) {
  EXPECT_EQ(Read("Elapsed,Time,x\n0,5,1\n1,6,2\n0,7,3\n").time, 1u);
  const Record unsure = Read("Zeit,Time,x\n0,5,1\n1,6,2\n2,7,3\n");
  EXPECT_EQ(unsure.time, std::nullopt);
  EXPECT_THAT(unsure.notes, Contains(HasSubstr("\"Zeit\" and \"Time\" could both be the time")));
  // One that falls is the time all the same where it is the only one: then that is its fault.
  EXPECT_EQ(Read("Time,x\n0,5\n2,6\n1,7\n").time, 0u);
}

}  // namespace
}  // namespace dynoproof::trace
