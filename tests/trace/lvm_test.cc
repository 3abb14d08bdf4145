#include "trace/lvm.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

#include "tests/trace/parse_csv.h"

namespace dynoproof::trace {
namespace {

using test::MessageOf;
using test::Read;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

std::string Replaced(std::string text, const std::string& what, const std::string& by) {
  for (std::size_t at = 0; (at = text.find(what, at)) != std::string::npos; at += by.size()) {
    text.replace(at, what.size(), by);
  }
  return text;
}

const std::string kFile =
    "LabVIEW Measurement\t\nWriter_Version\t2\nSeparator\tTab\nDecimal_Separator\t,\nMulti_Headings\tYes\n"
    "X_Columns\tNo\nTime_Pref\tRelative\n***End_of_Header***\t\n\t\n"
    "Channels\t2\t\t\nSamples\t3\t3\t\nY_Unit_Label\tNm\trad/s\t\nX_Dimension\tTime\tTime\t\n"
    "X0\t0,5\t0,5\t\nDelta_X\t2,5E-1\t2,5E-1\t\n***End_of_Header***\t\t\t\n"
    "X_Value\tTorque\tSpeed\tComment\n\t1,5\t2\tstart\n\t-3\t4,25\n\t5e1\t6\t\n";

TEST(Lvm, TimesAreThoseOfTheHeader) {
  const Record record = Read(kFile);
  ASSERT_THAT(record.Names(), ElementsAre("time", "Torque", "Speed"));
  EXPECT_THAT(record.columns[0].values, ElementsAre(0.5, 0.75, 1.0));
  EXPECT_THAT(record.columns[1].values, ElementsAre(1.5, -3.0, 50.0));
  EXPECT_THAT(record.columns[2].values, ElementsAre(2.0, 4.25, 6.0));
  EXPECT_EQ(record.columns[0].unit, "s");
  EXPECT_EQ(record.columns[1].unit, "Nm");
  EXPECT_EQ(record.time, 0u);
  EXPECT_EQ(record.columns[2].time, 0u);
  EXPECT_THAT(record.non_finite, IsEmpty());
}

TEST(Lvm, OneXColumnAndCommas) {
  std::string text = Replaced(Replaced(kFile, ",", "."), "\t", ",");
  text = Replaced(Replaced(text, "Decimal_Separator,.", "Decimal_Separator,."), "X_Columns,No", "X_Columns,One");
  text = Replaced(Replaced(Replaced(text, "\n,1.5", "\n0,1.5"), "\n,-3", "\n0.1,-3"), "\n,5e1", "\n0.3,5e1");
  const Record record = Read(text);
  ASSERT_THAT(record.Names(), ElementsAre("time", "Torque", "Speed"));
  EXPECT_THAT(record.columns[0].values, ElementsAre(0.0, 0.1, 0.3));
  EXPECT_EQ(record.Find("X_Value"), 0u);
}

TEST(Lvm, WhatCannotBeReadIsSaidInOneSentence) {
  EXPECT_THAT(MessageOf(Replaced(kFile, "X_Columns\tNo", "X_Columns\tMulti")),
              HasSubstr("an X column for every channel"));
  EXPECT_THAT(MessageOf(Replaced(kFile, "X0\t0,5\t0,5", "X0\t0,5\t0,6")), HasSubstr("not the same for all channels"));
  EXPECT_THAT(MessageOf(Replaced(kFile, "Delta_X", "Delta")), HasSubstr("X0 and Delta_X are not whole"));
  EXPECT_THAT(MessageOf(kFile + "\t\t\t\nChannels\t2\n"), HasSubstr("a second block begins"));
  EXPECT_THAT(MessageOf("LabVIEW Measurement\nSeparator\tTab\n"),
              HasSubstr("LabVIEW measurement file (LVM) whose header"));
  EXPECT_THAT(MessageOf(kFile.substr(0, kFile.find("Channels"))), HasSubstr("without a block of channels"));
}

}  // namespace
}  // namespace dynoproof::trace
