#include "trace/csv_text.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <array>
#include <string>

namespace dynoproof::trace::csv {
namespace {

/// A pipe that holds `text` and is closed behind it.
class Pipe {
 public:
  explicit Pipe(const std::string& text) {
    EXPECT_EQ(::pipe(ends_.data()), 0);
    EXPECT_EQ(::write(ends_[1], text.data(), text.size()), static_cast<ssize_t>(text.size()));
    ::close(ends_[1]);
  }
  ~Pipe() { ::close(ends_[0]); }
  int descriptor() const { return ends_[0]; }

 private:
  std::array<int, 2> ends_ = {};
};

TEST(CsvText, LinesStopAtTheLimit) {
  const Pipe pipe("abcdefghij\n0123456789\n");
  Lines lines(pipe.descriptor(), 21, "too much");
  EXPECT_EQ(lines.Next(), std::nullopt);
  EXPECT_EQ(lines.fault(), "too much");
}

TEST(CsvText, LinesTellWhetherTheLastIsClosed) {
  for (const std::string end : {"", "\n", "\r", "\r\r\n"}) {
    const Pipe pipe("a\nb" + end);
    Lines lines(pipe.descriptor(), 100, "");
    EXPECT_EQ(lines.Next(), "a");
    EXPECT_FALSE(lines.open_end());
    EXPECT_EQ(lines.Next(), "b");
    EXPECT_EQ(lines.open_end(), end.empty()) << end.size();
    EXPECT_EQ(lines.Next(), std::nullopt);
  }
}

TEST(CsvText, NumbersOfManyHands) {
  NumberReader points(false);
  EXPECT_EQ(points.Read("1.0D+03"), 1000.0);
  EXPECT_EQ(points.Read("-2d-2"), -0.02);
  EXPECT_EQ(points.Read("+1.5D0"), 1.5);
  EXPECT_EQ(points.Read("1,5"), std::nullopt);
  NumberReader commas(true);
  EXPECT_EQ(commas.Read("1,5D1"), 15.0);
  EXPECT_EQ(commas.Read("1.5"), std::nullopt);
  for (const char* word : {"D", "1D", "D1", "1D2D3", "1DD2", "2d.5", "d", "1e5d2"}) {
    EXPECT_EQ(points.Read(word), std::nullopt) << word;
  }
}

TEST(CsvText, MarksThatMayPartThousands) {
  for (const char* may : {"1,234", "12.345", "-123,456", "+1,000"}) EXPECT_TRUE(LooksLikeThousands(may)) << may;
  for (const char* cannot : {"0,123", "1234,567", "1,23", "1,2345", "1234", ",123", "1,23e", "1,234e5"}) {
    EXPECT_FALSE(LooksLikeThousands(cannot)) << cannot;
  }
}

TEST(CsvText, BlanksSeparate) {
  EXPECT_EQ(Split("a  b\t\"c d\"", ' '), (std::vector<std::string>{"a", "b", "c d"}));
  EXPECT_EQ(Split("a b   c\td e", kWideBlanks), (std::vector<std::string>{"a b", "c", "d e"}));
  EXPECT_EQ(Split("\"a", ','), std::nullopt);
}

}  // namespace
}  // namespace dynoproof::trace::csv
