#include <gmock/gmock.h>
#include <gtest/gtest.h>

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

std::vector<std::string> UnitsOf(const Record& record) {
  std::vector<std::string> units;
  for (const Column& column : record.columns) units.push_back(column.unit);
  return units;
}

struct Dialect {
  std::string name, text;
};

// Every one of these is the same record: t = 0, 0.5; M = 1.25, -3000.
TEST(CsvDialects, GalleryOfOneRecord) {
  const std::vector<Dialect> gallery = {
      {"CR", "t,M\r0,1.25\r0.5,-3000\r"},
      {"CR without the last", "t,M\r0,1.25\r0.5,-3000"},
      {"CR CR LF", "t,M\r\r\n0,1.25\r\r\n0.5,-3000\r\r\n"},
      {"CR LF CR LF", "t,M\r\n\r\n0,1.25\r\n\r\n0.5,-3000\r\n\r\n"},
      {"sep=", "sep=;\nt;M\n0;1,25\n0,5;-3000\n"},
      {"Sep= with a mark and CRLF", "\xEF\xBB\xBFSep=,\r\nt,M\r\n0,1.25\r\n0.5,-3000\r\n"},
      {"sep= of a tab", "sep=\t\nt\tM\n0\t1.25\n0.5\t-3000\n"},
      {"sep= of a bar", "\"sep=|\"\nt|M\n0|1.25\n0.5|-3000\n"},
      {"quoted decimal comma between commas", "t,M\n0,\"1,25\"\n\"0,5\",-3000\n"},
      {"all quoted", "\"t\";\"M\"\n\"0\";\"1,25\"\n\"0,5\";\"-3000\"\n"},
      {"quoted names, blanks", "\"t\", \"M\"\n0, 1.25\n0.5, -3000\n"},
      {"one blank", "t M\n0 1.25\n0.5 -3000\n"},
      {"blanks", "   t        M\n   0.0      1.25\n   0.5  -3000.0\n"},
      {"blanks and tabs", "t \tM\n0 \t1.25\n0.5\t -3000\n"},
      {"blanks and decimal comma", "t M\n0 1,25\n0,5 -3000\n"},
      {"Fortran", "  t   M\n  0.0D+00   0.125D+01\n  5.0d-01  -3.0D3\n"},
      {"Fortran and comma", "t,M\n0.0D+00,0.125D+01\n+0.5d0,-3.0D+03\n"},
      {"names in a comment", "# t M\n0 1.25\n0.5 -3000\n"},
      {"names in the last comment", "#made on a Monday\n#t,M\n0,1.25\n0.5,-3000\n"},
      {"rows of separators at the end", "t;M\n0;1.25\n0.5;-3000\n;\n;\n"},
      {"rows of separators between", "t;M\n0;1.25\n;\n0.5;-3000\n"},
      {"words behind", "t,M\n0,1.25\n0.5,-3000\nEnd of file\nby logger, number, 7b\n"},
      {"columns of separators", "t;M;;;\n0;1.25;;;\n0.5;-3000;;;\n"},
      {"end of a file in DOS", "t,M\n0,1.25\n0.5,-3000\n\x1A"},
      {"preamble", "Logger 7\nRate: 2 Hz, 2 channels, by hand\n\nt,M\n0,1.25\n0.5,-3000\n"},
      {"preamble of pairs", "Device,ABC\nRate,1000\nt,M\n0,1.25\n0.5,-3000\n"},
      {"preamble as wide as the table", "Device;ABC\nt;M\n0;1,25\n0,5;-3000\n"},
      {"preamble of one number", "400\nt\tM\n0\t1.25\n0.5\t-3000\n"},
  };
  for (const Dialect& dialect : gallery) {
    const Record record = Read(dialect.text);
    ASSERT_THAT(record.Names(), ElementsAre("t", "M")) << dialect.name;
    EXPECT_THAT(record.columns[0].values, ElementsAre(0.0, 0.5)) << dialect.name;
    EXPECT_THAT(record.columns[1].values, ElementsAre(1.25, -3000.0)) << dialect.name;
    EXPECT_EQ(record.time, 0u) << dialect.name;
    EXPECT_THAT(record.non_finite, IsEmpty()) << dialect.name;
    EXPECT_THAT(record.left_out, IsEmpty()) << dialect.name;
    EXPECT_THAT(UnitsOf(record), ElementsAre("", "")) << dialect.name;
  }
}

// Every one of these has t in ms and M in N m, each in its own spelling: 0, 5; 1, 6.
TEST(CsvDialects, GalleryOfUnits) {
  const std::vector<std::pair<Dialect, std::vector<std::string>>> gallery = {
      {{"row", "t,M\nms,N m\n0,5\n1,6\n"}, {"ms", "N m"}},
      {{"row behind an empty one", "t,M\n(ms),(Nm)\n\n0,5\n1,6\n"}, {"ms", "Nm"}},
      {{"square brackets", "t;M\n[ms];[N.m]\n0;5\n1;6\n"}, {"ms", "N.m"}},
      {{"written out", "t,M\nmilliseconds,Newton meters\n0,5\n1,6\n"}, {"milliseconds", "Newton meters"}},
      {{"only one", "t,M\nms,\n0,5\n1,6\n"}, {"ms", ""}},
      {{"one of two known", "t,M\nms,furlongs\n0,5\n1,6\n"}, {"ms", "furlongs"}},
      {{"unknown in brackets", "t,M\n[ms],[furlongs]\n0,5\n1,6\n"}, {"ms", "furlongs"}},
      {{"none", "t,M\n,\n0,5\n1,6\n"}, {"", ""}},
      {{"no dimension", "t,M\nms,1\n0,5\n1,6\n"}, {"ms", "1"}},
      {{"in the names", "t [ms],M [Nm]\n0,5\n1,6\n"}, {"ms", "Nm"}},
      {{"in the names, round", "t (ms),M (N*m)\n0,5\n1,6\n"}, {"ms", "N*m"}},
      {{"in the names, close", "t(ms);M(kg m^2/(s^2))\n0;5\n1;6\n"}, {"ms", "kg m^2/(s^2)"}},
      {{"behind a slash", "t/ms,M/(N m)\n0,5\n1,6\n"}, {"ms", "N m"}},
      {{"behind a slash with blanks", "t / ms\tM / Nm\n0\t5\n1\t6\n"}, {"ms", "Nm"}},
      {{"in names and in a row, which wins", "t [s],M\nms,Nm\n0,5\n1,6\n"}, {"ms", "Nm"}},
      {{"in comments", "# t M\n# ms Nm\n0 5\n1 6\n"}, {"ms", "Nm"}},
      {{"v over a bracket", "t/(ms),M/(N m)\n0,5\n1,6\n"}, {"ms", "N m"}},
      {{"in names with blanks", "t (ms)   M (N m)\n 0.0     5.0\n  1.0      6.0\n"}, {"ms", "N m"}},
      {{"below a row of kinds", "Item file\nsampleCount 2\nt\tM\nf8\tf8\nms\tNm\n0\t5\n1\t6\n"}, {"ms", "Nm"}},
      {{"below a preamble as wide", "Device,ABC\nt,M\nms,N m\n0,5\n1,6\n"}, {"ms", "N m"}},
  };
  for (const auto& [dialect, units] : gallery) {
    const Record record = Read(dialect.text);
    ASSERT_THAT(record.Names(), ElementsAre("t", "M")) << dialect.name;
    EXPECT_EQ(UnitsOf(record), units) << dialect.name;
    EXPECT_THAT(record.columns[0].values, ElementsAre(0.0, 1.0)) << dialect.name;
    EXPECT_THAT(record.columns[1].values, ElementsAre(5.0, 6.0)) << dialect.name;
    EXPECT_EQ(record.time, 0u) << dialect.name;
  }
}

TEST(CsvDialects, ColumnIsFoundByNameAndByWholeHeading) {
  const Record record = Read("time [ms],T_shaft/Nm,x (left),n (rpm)\n0,5,6,7\n");
  EXPECT_THAT(record.Names(), ElementsAre("time", "T_shaft", "x (left)", "n"));
  EXPECT_THAT(UnitsOf(record), ElementsAre("ms", "Nm", "", "rpm"));
  EXPECT_EQ(record.Find("T_shaft"), 1u);
  EXPECT_EQ(record.Find("T_shaft/Nm"), 1u);
  EXPECT_EQ(record.Find("time [ms]"), 0u);
  EXPECT_EQ(record.Find(""), std::nullopt);
}

TEST(CsvDialects, NamesThatOnlyTheUnitTellsApartStayWhole) {
  const Record record = Read("t,T [Nm],T [degC]\n0,5,6\n");
  EXPECT_THAT(record.Names(), ElementsAre("t", "T [Nm]", "T [degC]"));
  EXPECT_THAT(UnitsOf(record), ElementsAre("", "Nm", "degC"));
}

TEST(CsvDialects, WhatIsNoUnitStaysInTheName) {
  const Record record = Read("t,x (1),x (2),V1/V2,a/b,m/s,y [1]\n0,1,2,3,4,5,6\n");
  EXPECT_THAT(record.Names(), ElementsAre("t", "x (1)", "x (2)", "V1/V2", "a/b", "m/s", "y"));
  EXPECT_THAT(UnitsOf(record), ElementsAre("", "", "", "", "", "", "1"));
}

TEST(CsvDialects, NoRowOfDataIsTakenForUnits) {
  for (const std::string first : {"0 x", "1,A", "0,broken", "-,-", "N/A,N/A", "1D+,3"}) {
    const bool blanks = first.find(' ') != std::string::npos;
    const Record record = Read((blanks ? "t M\n" : "t,M\n") + first + (blanks ? "\n1 2\n2 3\n" : "\n1,2\n2,3\n"));
    ASSERT_EQ(record.columns.size(), 2u) << first;
    EXPECT_EQ(record.columns[1].values.size(), 3u) << first;
    EXPECT_THAT(record.notes, ::testing::Not(IsEmpty())) << first;
  }
  // "A" is a unit and a gear: a word in a column of words is none.
  const Record record = Read("t,x,gear\n1,1,A\n2,1,V\n3,2,s\n");
  ASSERT_THAT(record.Names(), ElementsAre("t", "x"));
  EXPECT_THAT(record.columns[0].values, ElementsAre(1.0, 2.0, 3.0));
}

TEST(CsvDialects, NumberedChannels) {
  Record record = Read("x-axis,1,2\nsecond,Volt,Volt\n-0.1,5,6\n0,5,6\n");
  EXPECT_THAT(record.Names(), ElementsAre("x-axis", "1", "2"));
  EXPECT_THAT(UnitsOf(record), ElementsAre("second", "Volt", "Volt"));
  EXPECT_THAT(record.columns[0].values, ElementsAre(-0.1, 0.0));
  record = Read("t,1,2\n0,5,6\n0.1,5,6\n");
  EXPECT_THAT(record.Names(), ElementsAre("t", "1", "2"));
}

TEST(CsvDialects, SkippedPreambleAndNamesInACommentAreNoted) {
  EXPECT_THAT(Read("Logger\nt,M\n0,1\n").notes,
              ElementsAre(AllOf(HasSubstr("line 2"), HasSubstr("line 1 first: \"Logger\""))));
  EXPECT_THAT(Read("#t,M\n0,1\n").notes, ElementsAre(HasSubstr("comment in line 1")));
}

TEST(CsvDialects, RowsWithoutAnyValueAndWordsBehindAreNoted) {
  EXPECT_THAT(Read("t;M\n0;1\n;\n;\n1;2\n").notes,
              ElementsAre("2 rows without any value are left out, the first in line 3"));
  EXPECT_THAT(Read("t,M\n0,1\nEnd\n").notes, ElementsAre("1 line behind the rows is skipped, line 3 first: \"End\""));
  // Without times an empty row is a sample that is missing: it stays, but for the end of the file.
  const Record record = Read("x;M\n0;1\n;\n1;2\n\n;\n;\n");
  EXPECT_EQ(record.columns[0].values.size(), 3u);
  EXPECT_EQ(record.non_finite.size(), 2u);
  EXPECT_THAT(record.notes, ElementsAre("2 rows without any value are left out, the first in line 6"));
}

TEST(CsvDialects, OneDecimalMarkAFile) {
  // The mark that cannot part thousands wins; the other one's cells are no numbers.
  Record record = Read("a;b\n1,234;0.5\n2,345;0.25\n");
  EXPECT_THAT(record.Names(), ElementsAre("b"));
  EXPECT_THAT(record.columns[0].values, ElementsAre(0.5, 0.25));
  EXPECT_THAT(record.left_out,
              ElementsAre(std::pair<std::string, std::string>(
                  "a",
                  "is not read: in line 2, \"1,234\" has another decimal mark than the other numbers, which have "
                  "\".\"")));
  record = Read("a;b\n1.234;0,5\n2.345;0,25\n");
  EXPECT_THAT(record.columns[0].values, ElementsAre(0.5, 0.25));
  // A version number between decimal commas.
  record = Read("v;b;c\n1.5;0,5;1,5\n1.5;0,25;2,5\n");
  EXPECT_THAT(record.Names(), ElementsAre("b", "c"));
}

TEST(CsvDialects, CommaThatMayPartThousandsIsNotGuessed) {
  EXPECT_THAT(MessageOf("a,b\n\"1,234\",\"2,345\"\n"), HasSubstr("may part thousands"));
  const Record record = Read("a,b\n\"1,234\",7\n\"2,345\",8\n");
  EXPECT_THAT(record.Names(), ElementsAre("b"));
  EXPECT_THAT(Read("a;b\n1,234;7\n").columns[0].values, ElementsAre(1.234));
  // Whole numbers as far as the first lines go, and then a comma.
  std::string text = "a\tb\n";
  for (int i = 400; i < 1100; ++i) text += std::to_string(i) + (i < 1000 ? "\t7\n" : "\t1,000\n");
  EXPECT_THAT(Read(text).notes, ElementsAre(HasSubstr("line 602: \"1,000\" has a comma that may part thousands")));
  EXPECT_THAT(Read("a,b\n\"1,234\",7\n\"0,345\",8\n").columns[0].values, ElementsAre(1.234, 0.345));
}

TEST(CsvDialects, LineNumbersCountWhatEditorsCount) {
  for (const std::string end : {"\n", "\r\n", "\r\r\n", "\r"}) {
    const std::string text = "t,M" + end + end + "0,1" + end + "1,2" + end + "2" + end;
    EXPECT_THAT(MessageOf(text), HasSubstr("line 5: 1 cell")) << text;
  }
}

TEST(CsvDialects, LineEndsMayCrossTheBlocksOfTheReader) {
  // 1 MB blocks: carriage returns stand at every place around their ends.
  for (const std::string end : {"\r\n", "\r\r\n", "\r"}) {
    for (std::size_t shift = 0; shift < 4; ++shift) {
      std::string text = "a,b" + end + "#" + std::string(shift, 'x') + end;
      std::size_t rows = 0;
      for (; text.size() < (std::size_t{5} << 18); ++rows) text += "1,2" + end;
      const Record record = Read(text);
      ASSERT_EQ(record.columns.size(), 2u);
      EXPECT_EQ(record.columns[1].values.size(), rows);
      EXPECT_THAT(record.notes, IsEmpty());
    }
  }
}

}  // namespace
}  // namespace dynoproof::trace
