#include "reduce/cut.h"

#include <gtest/gtest.h>

namespace dynoproof::reduce {
namespace {

TEST(ShortestCut, FindsAStretch) {
  for (const auto& [begin, end] :
       {std::pair(4000UL, 4200UL), std::pair(0UL, 10UL), std::pair(9990UL, 10000UL), std::pair(0UL, 10000UL)}) {
    int asked = 0;
    const Cut cut = ShortestCut(10000, 3, 100, [&, begin = begin, end = end](std::size_t first, std::size_t last) {
      ++asked;
      EXPECT_LT(first, last);
      EXPECT_LE(last, 10000U);
      return first <= begin && last >= end;
    });
    EXPECT_LE(cut.first, begin);
    EXPECT_GE(cut.last, end);
    // A tenth at either side, and two rows where a tenth is less than one.
    EXPECT_LE(static_cast<double>(cut.last - cut.first), 1.1 * 1.1 * static_cast<double>(end - begin) + 2.0);
    EXPECT_EQ(cut.tries, asked);
    EXPECT_TRUE(cut.complete);
    EXPECT_LE(asked, 60);
  }
}

TEST(ShortestCut, KeepsTheFirstOfTwo) {
  const auto shows = [](std::size_t first, std::size_t last) {
    return (first <= 100 && last >= 150) || (first <= 800 && last >= 850);
  };
  const Cut cut = ShortestCut(1000, 3, 100, shows);
  EXPECT_LE(cut.last, 200U);
  EXPECT_TRUE(shows(cut.first, cut.last));
}

TEST(ShortestCut, KeepsToItsLimits) {
  const Cut few = ShortestCut(1000, 30, 100, [](std::size_t, std::size_t) { return true; });
  EXPECT_EQ(few.last - few.first, 30U);
  const Cut stopped =
      ShortestCut(100000, 3, 4, [](std::size_t first, std::size_t last) { return first <= 50000 && last > 50000; });
  EXPECT_FALSE(stopped.complete);
  EXPECT_EQ(stopped.tries, 4);
  EXPECT_TRUE(stopped.first <= 50000 && stopped.last > 50000);
}

}  // namespace
}  // namespace dynoproof::reduce
