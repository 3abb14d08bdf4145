#include "trace/csv.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <cmath>
#include <cstring>
#include <limits>
#include <random>
#include <thread>

#include "tests/support/temp_dir.h"
#include "tests/trace/parse_csv.h"
#include "trace/csv_write.h"

namespace dynoproof::trace {
namespace {

using dynoproof::test::TempDir;
using test::MessageOf;
using test::Parse;
using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;

struct Good {
  std::string name, text;
};

// Every one of these is the same record: t = 0, 0.5; M = 1.25, -3000.
TEST(Csv, GalleryOfOneRecord) {
  const std::vector<Good> gallery = {
      {"plain", "t,M\n0,1.25\n0.5,-3000\n"},
      {"no end of line", "t,M\n0,1.25\n0.5,-3000"},
      {"CRLF", "t,M\r\n0,1.25\r\n0.5,-3000\r\n"},
      {"byte order mark", "\xEF\xBB\xBFt,M\n0,1.25\n0.5,-3000\n"},
      {"blanks", "t , M\n 0 ,\t1.25\n  0.5,-3000  \n"},
      {"comments and empty lines", "# logger 7\n\nt,M\n# data\n0,1.25\n   \n0.5,-3000\n#end"},
      {"semicolon", "t;M\n0;1.25\n0.5;-3000\n"},
      {"decimal comma", "t;M\n0;1,25\n0,5;-3000\n"},
      {"tab", "t\tM\n0\t1.25\n0.5\t-3000\n"},
      {"tab and decimal comma", "t\tM\n0\t1,25\n0,5\t-3000\n"},
      {"exponents and signs", "t,M\n+0e0,1.25E+00\n5e-1,-.3e4\n"},
      {"quoted", "\"t\",\"M\"\n\"0\",\"1.25\"\n0.5,-3000\n"},
      {"separator at the end", "t,M,\n0,1.25,\n0.5,-3000,\n"},
      {"separator at the end of the data only", "t;M\n0;1.25;\n0.5;-3000;\n"},
  };
  for (const Good& good : gallery) {
    const Result<Record> record = Parse(good.text);
    ASSERT_TRUE(record.ok()) << good.name << ": " << record.failure().message;
    EXPECT_THAT(record->Names(), ElementsAre("t", "M")) << good.name;
    EXPECT_THAT(record->columns[0].values, ElementsAre(0.0, 0.5)) << good.name;
    EXPECT_THAT(record->columns[1].values, ElementsAre(1.25, -3000.0)) << good.name;
    EXPECT_EQ(record->time, 0u) << good.name;
    EXPECT_EQ(record->columns[1].time, 0u) << good.name;
    EXPECT_EQ(record->columns[0].time, std::nullopt) << good.name;
    EXPECT_THAT(record->non_finite, IsEmpty()) << good.name;
    EXPECT_EQ(record->columns[0].unit, "") << good.name;
  }
}

TEST(Csv, QuotedNamesMayHoldSeparatorsAndQuotes) {
  const Result<Record> record = Parse("t,\"M, \"\"left\"\"; Nm\"\n0,1\n");
  ASSERT_TRUE(record.ok()) << record.failure().message;
  EXPECT_THAT(record->Names(), ElementsAre("t", "M, \"left\"; Nm"));
}

TEST(Csv, UnitsRow) {
  const auto units = [](const std::string& text) {
    const Result<Record> record = Parse(text);
    EXPECT_TRUE(record.ok()) << text << record.failure().message;
    std::vector<std::string> found;
    if (!record.ok()) return found;
    EXPECT_THAT(record->columns[0].values, ElementsAre(0.0)) << text;
    for (const Column& column : record->columns) found.push_back(column.unit);
    return found;
  };
  EXPECT_THAT(units("t,M,s\ns,N m,1\n0,5,6\n"), ElementsAre("s", "N m", "1"));
  EXPECT_THAT(units("t;M;s\n[s];(kN m);-\n0;5;6\n"), ElementsAre("s", "kN m", "1"));
  EXPECT_THAT(units("t,M,s\ns,,\n0,5,6\n"), ElementsAre("s", "", ""));
  // `nan` is a number that is not finite, not a unit.
  const Result<Record> record = Parse("x\nnan\n2\n");
  ASSERT_TRUE(record.ok());
  EXPECT_EQ(record->columns[0].values.size(), 2u);
}

TEST(Csv, TimeColumnIsOptionalAndItsNameExact) {
  Result<Record> record = Parse("T,x\n1,2\n");
  ASSERT_TRUE(record.ok());
  EXPECT_EQ(record->time, std::nullopt);
  EXPECT_EQ(record->columns[1].time, std::nullopt);
  record = Parse("x,time\n1,2\n");
  ASSERT_TRUE(record.ok());
  EXPECT_EQ(record->time, 1u);
  EXPECT_EQ(record->columns[0].time, 1u);
  record = Parse("time,t\n1,2\n");
  ASSERT_TRUE(record.ok());
  EXPECT_EQ(record->time, 0u);
  EXPECT_THAT(record->notes, ElementsAre(HasSubstr("the first is taken")));
}

TEST(Csv, EmptyAndNotFiniteCellsAreKeptAndReported) {
  const Result<Record> record = Parse("# head\nt,a,b,c\n0,1,2,3\n1,,NaN,3\n2,1,-inf,3\n3,,2,3\n");
  ASSERT_TRUE(record.ok()) << record.failure().message;
  ASSERT_EQ(record->non_finite.size(), 2u);
  EXPECT_EQ(record->non_finite[0].column, 1u);
  EXPECT_EQ(record->non_finite[0].count, 2u);
  EXPECT_EQ(record->non_finite[0].first_row, 1u);
  EXPECT_EQ(record->non_finite[0].first_line, 4u);
  EXPECT_TRUE(std::isnan(record->columns[1].values[3]));
  EXPECT_EQ(record->columns[2].values[2], -std::numeric_limits<double>::infinity());
  EXPECT_THAT(record->DescribeNonFinite(),
              ElementsAre(AllOf(HasSubstr("\"a\""), HasSubstr("2 of 4"), HasSubstr("line 4")),
                          AllOf(HasSubstr("\"b\""), HasSubstr("2 of 4"), HasSubstr("line 4"))));
}

TEST(Csv, BadRowsAreAllNamedUpToTwenty) {
  std::string text = "t,a\n";
  for (int i = 0; i < 60; ++i) text += std::to_string(i) + (i >= 5 && i < 30 ? "" : ",1") + "\n";
  const std::string message = MessageOf(text);
  EXPECT_THAT(message, AllOf(HasSubstr("25 bad rows"), HasSubstr("line 7: 1 cell, the row of names has 2"),
                             HasSubstr("line 26:"), Not(HasSubstr("line 27:")), HasSubstr("and 5 more")));
}

TEST(Csv, FaultsAreNamedWithTheirPlace) {
  const std::vector<std::pair<std::string, std::string>> faults = {
      {"", "is empty"},
      {"# only a comment\n", "is empty"},
      {"t,a\n", "no data"},
      {"t,a\ns,N m\n", "no data"},
      {"Dear all,\nplease find attached\n", "has no data: line 1 is \"Dear all,\""},
      {"0,1\n1,2\n", "line 1: expected a row of names"},
      {"made by 7\n0,1\n1,2\n", "line 2: a row of numbers with 2 cells, but no row of names before it has as many"},
      {"t,t,b\n0,1,2\n", "line 1: columns 1 and 2 are both \"t\""},
      {"t,\"a\n0,1\n", "line 1: a quote"},
      {"t,a\n0,1\n1\n", "line 3: 1 cell, the row of names has 2"},
      {"t,a\n0,1\nEnd of file\n1,2\n", "line 3: 1 cell"},
      {"\"t\" \"M\"\n\"1\" 0 5\n", "line 2: a row of numbers with 3 cells"},
      {"t,a\n0,1\n1", "the file ends there without a line end"},
      {"t,a\n0,1\n1,2,3\n", "line 3: 3 cells"},
      {"t,a\n0,1\n1,\"2\n", "line 3, column 2: a quote"},
      {"t,a\n0,1\n1,\"2\"3\n", "line 3, column 2: a quote"},
      {"gear,mode\nD,1\nD,x\nN,y\n", "no column of numbers"},
      {std::string("t,a\0b\n0,1\n", 10), "binary"},
      {"t,a\n" + std::string("0,1\n\0\0\n", 8), "zero byte near line 3"},
      {"\xFF\xFEt,a\n", "UTF-16"},
      {"\x89HDF\r\n\x1a\n", "HDF5"},
      {"PK\x03\x04..", "Excel workbook"},
      {"MATLAB 5.0 MAT-file, Platform: GLNXA64", "MAT file"},
      {"<?xml version=\"1.0\"?>", "XML"},
  };
  for (const auto& [text, said] : faults) EXPECT_THAT(MessageOf(text), HasSubstr(said)) << text;
  EXPECT_THAT(ReadCsv("nowhere/record.csv").failure().message, HasSubstr("no such file"));
  EXPECT_THAT(ReadCsv("/").failure().message, HasSubstr("directory"));
  EXPECT_THAT(ReadCsv("/dev/zero").failure().message, HasSubstr("is a device"));
}

TEST(Csv, ExtremesOfDoubles) {
  const Result<Record> record = Parse("x\n1e-400\n-1e-400\n4.9e-324\n1.7976931348623157e308\n0.1\n" +
                                      ("0." + std::string(390, '0') + "1") + "\n");
  ASSERT_TRUE(record.ok()) << record.failure().message;
  EXPECT_THAT(record->columns[0].values, ElementsAre(0.0, -0.0, std::numeric_limits<double>::denorm_min(),
                                                     std::numeric_limits<double>::max(), 0.1, 0.0));
  EXPECT_TRUE(std::signbit(record->columns[0].values[1]));
}

TEST(Csv, LinesMayCrossTheBlocksOfTheReader) {
  // Lines of very different lengths around the block size of 1 MB, one longer than a block.
  std::string text = "a,b\n";
  std::vector<double> expected;
  for (int i = 0; i < 40000; ++i) {
    text += std::string(static_cast<std::size_t>(i % 97), ' ') + std::to_string(i) + "," + std::to_string(-i) + "\n";
    expected.push_back(i);
  }
  text += std::string(std::size_t{3} << 20, ' ') + "40000,-40000\n";
  expected.push_back(40000);
  const Result<Record> record = Parse(text);
  ASSERT_TRUE(record.ok()) << record.failure().message;
  EXPECT_EQ(record->columns[0].values, expected);
}

TEST(Csv, PipeIsReadLikeAFile) {
  const TempDir dir;
  ASSERT_EQ(::mkfifo((dir / "pipe").c_str(), 0600), 0);
  std::thread writer([&] { std::ofstream(dir / "pipe") << "t,a\n0,1\n"; });
  const Result<Record> record = ReadCsv(dir / "pipe");
  writer.join();
  ASSERT_TRUE(record.ok());
  EXPECT_THAT(record->columns[1].values, ElementsAre(1.0));
}

TEST(Csv, FileThatGrowsWhileItIsReadIsRefused) {
  // A file of the system's own that says it has no bytes, and gives some.
  EXPECT_THAT(ReadCsv("/proc/self/stat").failure().message, HasSubstr("grew beyond its 0 bytes"));
}

TEST(Csv, WriteReadsBackBitForBit) {
  const TempDir dir;
  std::mt19937_64 random(7);
  std::vector<Column> columns = {
      {.name = "t", .unit = "s"}, {.name = "M; \"x\"", .unit = "N, m"}, {.name = "#n", .unit = "1"}};
  while (columns[0].values.size() < 20000) {
    for (Column& column : columns) {
      double value = 0.0;
      do {  // any bit pattern that is a finite number
        const std::uint64_t bits = random();
        std::memcpy(&value, &bits, sizeof(value));
      } while (!std::isfinite(value));
      column.values.push_back(value);
    }
  }
  for (const char separator : {',', ';', '\t'}) {
    ASSERT_EQ(WriteCsv(dir / "r.csv", columns, separator), std::nullopt);
    const Result<Record> record = ReadCsv(dir / "r.csv");
    ASSERT_TRUE(record.ok()) << record.failure().message;
    ASSERT_EQ(record->columns.size(), columns.size());
    for (std::size_t i = 0; i < columns.size(); ++i) {
      EXPECT_EQ(record->columns[i].name, columns[i].name);
      EXPECT_EQ(record->columns[i].unit, columns[i].unit);
      EXPECT_EQ(record->columns[i].values, columns[i].values);
    }
  }
}

TEST(Csv, WriteRefusesWhatIsNoTable) {
  const TempDir dir;
  const auto message = [&](const std::vector<Column>& columns) {
    const Status status = WriteCsv(dir / "r.csv", columns);
    EXPECT_TRUE(status);
    return status ? status->message : "";
  };
  EXPECT_THAT(message({}), HasSubstr("no columns"));
  EXPECT_THAT(message({{.name = "a", .values = {1}}, {.name = "b"}}), HasSubstr("equal lengths"));
  EXPECT_THAT(message({{.name = "a"}, {.name = "a"}}), HasSubstr("twice"));
  EXPECT_THAT(dir.Names(), IsEmpty());
}

}  // namespace
}  // namespace dynoproof::trace
