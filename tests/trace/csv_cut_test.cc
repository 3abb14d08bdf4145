#include "trace/csv_cut.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "tests/trace/parse_csv.h"

namespace dynoproof::trace {
namespace {

using test::Read;
using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

constexpr std::size_t kRows = 100;

std::string File(const std::function<std::string(int)>& cell) {
  std::string text = "t,x";
  for (std::size_t i = 0; i < kRows; ++i) text += fmt::format("\n{},{}", i, cell(static_cast<int>(i)));
  return text;
}

double Wave(int i) { return 30.0 * std::sin(0.7 * i + 1.0); }

TEST(CsvCut, FixedFormatsShowEveryCut) {
  for (const char* format : {"{:.6f}", "{:.8e}", "{:.3e}"}) {
    const auto cell = [&](int i) { return fmt::format(fmt::runtime(format), Wave(i)); };
    const std::string text = File(cell);
    const Record whole = Read(text);
    EXPECT_EQ(whole.columns[1].values.size(), kRows) << format;
    EXPECT_THAT(whole.notes, IsEmpty()) << format;
    const std::size_t length = cell(static_cast<int>(kRows) - 1).size();
    for (std::size_t cut = 1; cut <= length; ++cut) {
      const Record record = Read(text.substr(0, text.size() - cut));
      ASSERT_EQ(record.columns.size(), 2u);
      EXPECT_EQ(record.columns[1].values.size(), kRows - 1) << format << " less " << cut;
      EXPECT_THAT(record.notes, ElementsAre(AllOf(HasSubstr("line 101"), HasSubstr("may be cut"))));
    }
  }
}

TEST(CsvCut, ShortestDecimalsShowWhatMatters) {
  const std::string text = File([](int i) { return fmt::format("{}", Wave(i)); });
  const double last = Wave(static_cast<int>(kRows) - 1);
  const std::size_t length = fmt::format("{}", last).size();
  for (std::size_t cut = 0; cut <= length; ++cut) {
    const Record record = Read(text.substr(0, text.size() - cut));
    // What is taken differs by the last of 16 digits at most.
    if (record.columns[1].values.size() == kRows) {
      EXPECT_NEAR(record.columns[1].values.back(), last, 1e-14 * std::abs(last)) << cut;
    }
  }
}

TEST(CsvCut, WholeNumbersMustNotJump) {
  EXPECT_THAT(Read(File([](int i) { return std::to_string(950 + i); })).notes, IsEmpty());
  // 1049 less one and two digits.
  const std::string text = File([](int i) { return std::to_string(950 + i); });
  EXPECT_EQ(Read(text.substr(0, text.size() - 1)).columns[1].values.size(), kRows - 1);
  EXPECT_EQ(Read(text.substr(0, text.size() - 2)).columns[1].values.size(), kRows - 1);
  EXPECT_THAT(Read(File([](int) { return "0"; })).notes, IsEmpty());
}

TEST(CsvCut, ALineEndOrASeparatorClosesTheNumber) {
  const std::string text = File([](int i) { return i + 1 < static_cast<int>(kRows) ? "1.25" : "1"; });
  EXPECT_EQ(Read(text).columns[1].values.size(), kRows - 1);
  EXPECT_EQ(Read(text + "\n").columns[1].values.size(), kRows);
  // Where every row ends with a separator, one that does not is cut, whatever its number looks like.
  EXPECT_EQ(Read("a;b;\n1;2;\n1;2;\n1;2").columns[1].values.size(), 2u);
  EXPECT_EQ(Read("a;b;\n1;2;\n1;2;\n1;2;").columns[1].values.size(), 3u);
}

}  // namespace
}  // namespace dynoproof::trace
