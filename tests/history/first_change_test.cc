#include "history/first_change.h"

#include <gtest/gtest.h>

#include <set>
#include <vector>

namespace dynoproof::history {
namespace {

TEST(FirstChange, IsFoundInASeriesOfAnyLengthByHalves) {
  for (std::size_t count = 1; count <= 130; ++count) {
    std::size_t halves = 0;
    while ((std::size_t{1} << halves) < count) ++halves;
    for (std::size_t first = 0; first < count; ++first) {
      std::size_t looks = 0;
      const FirstChange change = FindFirstChange(count, [&](std::size_t i) {
        ++looks;
        return i < first ? Look::kSame : Look::kChanged;
      });
      ASSERT_TRUE(change.found);
      ASSERT_EQ(change.first, first) << "of " << count;
      ASSERT_EQ(change.since, first);
      ASSERT_EQ(change.looks, looks);
      ASSERT_LE(looks, halves + 1);
    }
  }
}

TEST(FirstChange, IsNoneWhereTheLastIsAsTheFirst) {
  const FirstChange change = FindFirstChange(64, [](std::size_t) { return Look::kSame; });
  EXPECT_FALSE(change.found);
  EXPECT_LE(change.looks, 7U);
  EXPECT_FALSE(FindFirstChange(0, [](std::size_t) { return Look::kChanged; }).found);
}

TEST(FirstChange, GoesRoundWhatCannotBeBuilt) {
  for (std::size_t first = 0; first < 40; ++first) {
    const std::set<std::size_t> broken = {3, 4, 5, 19, 20, 21, 38};
    std::vector<std::size_t> asked;
    const FirstChange change = FindFirstChange(40, [&](std::size_t i) {
      asked.push_back(i);
      return broken.contains(i) ? Look::kCannot : i < first ? Look::kSame : Look::kChanged;
    });
    ASSERT_TRUE(change.found) << first;
    // The change lies between those that could be looked at.
    EXPECT_GE(change.first, first);
    EXPECT_LE(change.since, first);
    for (std::size_t i = change.since; i < change.first; ++i) EXPECT_TRUE(broken.contains(i)) << first << ": " << i;
    EXPECT_EQ(std::set(asked.begin(), asked.end()).size(), asked.size()) << "none is looked at twice";
  }
}

TEST(FirstChange, IsNoneWhereNothingCanBeLookedAt) {
  EXPECT_FALSE(FindFirstChange(9, [](std::size_t) { return Look::kCannot; }).found);
}

}  // namespace
}  // namespace dynoproof::history
