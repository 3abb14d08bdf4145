// Columns that nobody can use, cells that cannot be read: told, and no fault of the others.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "tests/trace/parse_csv.h"
#include "trace/csv.h"

namespace dynoproof::trace {
namespace {

using test::MessageOf;
using test::Read;
using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Pair;

TEST(CsvColumns, WordsAreLeftOut) {
  const Record record = Read("t,gear,x,on,when\n0,D,1,True,one of these\n1,D,2,False,days\n");
  EXPECT_THAT(record.Names(), ElementsAre("t", "x"));
  EXPECT_THAT(record.columns[1].values, ElementsAre(1.0, 2.0));
  EXPECT_EQ(record.columns[1].time, 0u);
  EXPECT_THAT(record.left_out,
              ElementsAre(Pair("gear", "is text: \"D\" in line 2"), Pair("on", "is text: \"True\" in line 2"),
                          Pair("when", "is text: \"one of these\" in line 2")));
  EXPECT_THAT(record.notes, ElementsAre(AllOf(HasSubstr("left out: \"gear\" is text"), HasSubstr("; \"on\" is text"))));
  EXPECT_THAT(record.non_finite, IsEmpty());
}

TEST(CsvColumns, NamelessOnesAreLeftOutAndCounted) {
  const Record record = Read(",t,,x\n7,0,8,1\n8,1,9,2\n");
  EXPECT_THAT(record.Names(), ElementsAre("t", "x"));
  EXPECT_THAT(record.left_out, ElementsAre(Pair("column 1", "has no name"), Pair("column 3", "has no name")));
  EXPECT_THAT(record.notes, ElementsAre("left out: column 1 has no name; column 3 has no name"));
}

TEST(CsvColumns, TwiceTheSameNameIsNeither) {
  const Record record = Read("t,x,y,x\n0,1,2,3\n");
  EXPECT_THAT(record.Names(), ElementsAre("t", "y"));
  EXPECT_THAT(record.left_out, ElementsAre(Pair("x", "is there twice in line 1 (columns 2 and 4)")));
  EXPECT_THAT(MessageOf("time,x,time\n0,1,2\n"), HasSubstr("columns 1 and 3 are both \"time\""));
}

TEST(CsvColumns, EmptyOnesAreLeftOut) {
  const Record record = Read("t,x,spare\n0,1,\n1,2,\n");
  EXPECT_THAT(record.Names(), ElementsAre("t", "x"));
  EXPECT_THAT(record.left_out, ElementsAre(Pair("spare", "is empty throughout")));
}

TEST(CsvColumns, TimeThatIsTextLeavesTheRecordWithoutTime) {
  const Record record = Read("time,x\n10 o'clock,1\n11 o'clock,2\n");
  EXPECT_THAT(record.Names(), ElementsAre("x"));
  EXPECT_EQ(record.time, std::nullopt);
  EXPECT_THAT(record.left_out, ElementsAre(Pair("time", HasSubstr("10 o'clock"))));
}

TEST(CsvColumns, BadCellsAmongNumbersAreGapsAndTold) {
  const Record record =
      Read("t,a,b\n0,1,1\n1,?,2\n2,x,3\n3,4,1e999\n4,5,0x1p3\n5,6,1.2.3\n6,7,--2\n7,8,5\n8,9,6\n9,1,7\n");
  ASSERT_THAT(record.Names(), ElementsAre("t", "a", "b"));
  EXPECT_TRUE(std::isnan(record.columns[1].values[1]));
  EXPECT_EQ(record.columns[1].values[3], 4.0);
  ASSERT_EQ(record.non_finite.size(), 2u);
  EXPECT_EQ(record.non_finite[0].count, 2u);
  EXPECT_EQ(record.non_finite[0].first_line, 3u);
  EXPECT_EQ(record.non_finite[1].count, 4u);
  EXPECT_THAT(
      record.notes,
      ElementsAre("column 2 (a): 2 of 10 cells are no number and left empty, the first in line 3: \"?\" is not a "
                  "number",
                  AllOf(HasSubstr("column 3 (b): 4 of 10"), HasSubstr("line 5: \"1e999\" is outside the range"))));
  EXPECT_THAT(record.left_out, IsEmpty());
}

TEST(CsvColumns, WhatIsWrongWithACellIsSaid) {
  const std::vector<std::pair<std::string, std::string>> cells = {
      {"1.2.3", "two marks"},
      {"1,234.5", "two marks"},
      {"0x1p3", "\"0x1p3\" is not a number"},
      {"--2", "not a number"},
      {"+-2", "not a number"},
      {"2,5", "another decimal mark than the other numbers, which have \".\""},
      {"1e999", "outside the range"},
      {"\x1B[31mred", "\"\\x1b[31mred\" is not a number"},
      {"\xB5", "\"\u00B5\" is not a number"},
  };
  for (const auto& [cell, said] : cells) {
    const Record record = Read("t;a\n0;1.5\n1;" + cell + "\n2;3\n");
    EXPECT_THAT(record.notes, ::testing::Contains(HasSubstr(said))) << cell;
    EXPECT_EQ(record.non_finite.size(), 1u) << cell;
  }
}

TEST(CsvColumns, TextThatIsNotUtf8IsConvertedWithANote) {
  const Record record = Read("t;Kraft [\xB5N];\x80\n0;1;2\n");
  ASSERT_EQ(record.columns.size(), 3u);
  EXPECT_EQ(record.columns[1].name, "Kraft");
  EXPECT_EQ(record.columns[1].unit, "\u00B5N");
  EXPECT_EQ(record.columns[1].heading, "Kraft [\u00B5N]");
  EXPECT_EQ(record.columns[2].name, "\u20AC");
  EXPECT_THAT(record.notes, ElementsAre(HasSubstr("line 1 is not UTF-8")));
  EXPECT_THAT(Read("t;Kraft [\u00B5N]\n0;1\n").notes, IsEmpty());
}

TEST(CsvColumns, NamesHoldNothingThatATerminalObeys) {
  const Record record = Read("t,a\x1B[2J,\u202Eb\n0,1,2\n");
  EXPECT_THAT(record.Names(), ElementsAre("t", "a\\x1b[2J", "\\u202eb"));
}

}  // namespace
}  // namespace dynoproof::trace
