// Records that lost rows.
#include "experiment/gaps.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <memory>

namespace dynoproof {
namespace {

using ::testing::HasSubstr;
using ::testing::SizeIs;

constexpr double kStep = 1e-3;

/// An input and an output, of each of `count` rows but those from `from` to before `to`; values are the rows' numbers.
MappedRecord Without(int count, int from, int to) {
  std::vector<double> time, values;
  for (int i = 0; i < count; ++i) {
    if (i >= from && i < to) continue;
    time.push_back(i * kStep), values.push_back(i);
  }
  MappedRecord record;
  const Series series{std::make_shared<const std::vector<double>>(time),
                      std::make_shared<const std::vector<double>>(values)};
  record.inputs["T"] = record.outputs["w"] = series;
  record.step_s["T"] = record.step_s["w"] = kStep;
  record.end_s = time.back();
  record.notes = {"of the whole"};
  return record;
}

TEST(PartsBetweenGaps, BeginAnewBehindAGap) {
  const std::vector<MappedRecord> parts = PartsBetweenGaps(Without(1000, 300, 340));
  ASSERT_THAT(parts, SizeIs(2));
  EXPECT_DOUBLE_EQ(parts[0].end_s, 0.299);
  EXPECT_DOUBLE_EQ(parts[1].end_s, 0.659);
  EXPECT_THAT(*parts[0].inputs.at("T").time, SizeIs(300));
  const Series& behind = parts[1].outputs.at("w");
  ASSERT_THAT(*behind.time, SizeIs(660));
  for (std::size_t i = 0; i < behind.time->size(); ++i) {
    EXPECT_EQ((*behind.time)[i], static_cast<double>(i) * kStep) << "still multiples of the step";
    EXPECT_EQ((*behind.values)[i], static_cast<double>(i + 340));
  }
  EXPECT_EQ(parts[0].notes.front(), "of the whole");
  EXPECT_THAT(parts[1].notes.front(), HasSubstr("part from 0.34 to 0.999 s"));
}

TEST(PartsBetweenGaps, AreOneWhereTheCourseCanBeGuessed) {
  EXPECT_THAT(PartsBetweenGaps(Without(1000, 0, 0)), SizeIs(1));
  const std::vector<MappedRecord> filled = PartsBetweenGaps(Without(1000, 300, 300 + kMostLost));
  ASSERT_THAT(filled, SizeIs(1));
  EXPECT_DOUBLE_EQ(filled[0].end_s, 0.999);
  EXPECT_THAT(PartsBetweenGaps(Without(1000, 300, 301 + kMostLost)), SizeIs(2));
}

TEST(PartsBetweenGaps, LeavesOutWhatIsTooShort) {
  const std::vector<MappedRecord> parts = PartsBetweenGaps(Without(1000, 20, 60));
  ASSERT_THAT(parts, SizeIs(1));
  EXPECT_DOUBLE_EQ(parts[0].end_s, 0.939);
  EXPECT_THAT(PartsBetweenGaps(Without(45, 15, 30)), SizeIs(1)) << "of nothing but short parts the record itself";
}

}  // namespace
}  // namespace dynoproof
