// What a check hands on of its comparison is what it judged.
#include "score/evidence.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>

namespace dynoproof::score {
namespace {

struct Courses {
  std::vector<double> time, reference, test;
  Courses() {
    for (int i = 0; i <= 200; ++i) {
      time.push_back(0.01 * i);
      reference.push_back(std::sin(2.0 * std::numbers::pi * time.back()));
      test.push_back(reference.back() + (i >= 120 && i < 130 ? 0.05 * (i - 119) : 0.01));
    }
  }
  Series Reference() const { return {time, reference}; }
  Series Test() const { return {time, test}; }
};

TEST(Evidence, OfATubeHasItsDistances) {
  const Courses courses;
  const TubeOptions options{.relative_width = 0.05, .nominal = 2.0};
  const TubeResult tube = CompareTube(courses.Reference(), courses.Test(), options);
  const SharedEvidence evidence = TubeEvidence({"T", "N m", "golden", "run"}, courses.Reference(), tube, options);
  ASSERT_NE(evidence, nullptr);
  EXPECT_EQ(evidence->time_s, courses.time);
  EXPECT_EQ(evidence->reference, courses.reference);
  EXPECT_EQ(evidence->test, courses.test);
  EXPECT_EQ(evidence->distance[evidence->worst], tube.worst_ratio);
  EXPECT_EQ(evidence->time_s[evidence->worst], tube.worst_time_s);
  ASSERT_TRUE(evidence->first && tube.first);
  EXPECT_EQ(evidence->time_s[*evidence->first], tube.first->time_s);
  EXPECT_EQ(evidence->lower[*evidence->first], tube.first->lower);
  EXPECT_EQ(evidence->upper[*evidence->first], tube.first->upper);
}

TEST(Evidence, OfABandKnowsItsWorstPlace) {
  const Courses courses;
  const SharedEvidence evidence =
      BandEvidence({"T", "N m", "reference", "run"}, Evidence::Rule::kRms, courses.Reference(), courses.Test(), 0.25);
  ASSERT_NE(evidence, nullptr);
  EXPECT_EQ(evidence->worst, 129u);
  EXPECT_NEAR(evidence->distance[129], 2.0, 1e-12);
  EXPECT_EQ(evidence->first.value_or(0), 125u);
  EXPECT_EQ(evidence->upper[7], courses.reference[7] + 0.25);
  EXPECT_EQ(evidence->lower[7], courses.reference[7] - 0.25);
}

TEST(Evidence, ThereIsNoneOfWhatWasNotCompared) {
  Courses courses;
  const Compared what{"T", "N m", "reference", "run"};
  EXPECT_EQ(BandEvidence(what, Evidence::Rule::kRms, courses.Reference(), courses.Test(), 0.0), nullptr);
  courses.test[7] = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(BandEvidence(what, Evidence::Rule::kRms, courses.Reference(), courses.Test(), 1.0), nullptr);
  const TubeOptions options{.relative_width = 0.05, .nominal = 2.0};
  const TubeResult tube = CompareTube(courses.Reference(), courses.Test(), options);
  EXPECT_EQ(TubeEvidence(what, courses.Reference(), tube, options), nullptr);
}

}  // namespace
}  // namespace dynoproof::score
