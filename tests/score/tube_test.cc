// Tubes: hand values, time bases, coverage, a brute-force twin, and what must never pass.
#include "score/tube.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "tests/score/signals.h"

namespace dynoproof::score {
namespace {

Signal Sine() {
  return Sampled(201, 0.01, [](double t) { return std::sin(2 * kPi * t); });
}

TEST(Tube, EqualSignalsHaveRatioZero) {
  const TubeResult r = CompareTube(Sine().View(), Sine().View(), {.relative_width = 1e-9, .nominal = 1.0});
  EXPECT_TRUE(r.ok()) << r.reason;
  EXPECT_EQ(r.worst_ratio, 0.0);
  EXPECT_EQ(r.points, 201U);
  EXPECT_EQ(r.from_s, 0.0);
  EXPECT_DOUBLE_EQ(r.to_s, 2.0);
  EXPECT_FALSE(r.first.has_value());
}

TEST(Tube, RatioFirstDivergenceAndFractionByHand) {
  // Reference 0 on 0 .. 10 s, h = 0.5 * 4 = 2. The test is 1 (ratio 0.5) but 3 at 4, 5 and 6 s (ratio 1.5).
  const Signal reference = Sampled(11, 1.0, [](double) { return 0.0; });
  const Signal test = Sampled(11, 1.0, [](double t) { return t >= 4 && t <= 6 ? 3.0 : 1.0; });
  const TubeResult r = CompareTube(reference.View(), test.View(), {.relative_width = 0.5, .nominal = 4.0});
  EXPECT_FALSE(r.ok());
  EXPECT_DOUBLE_EQ(r.worst_ratio, 1.5);
  EXPECT_DOUBLE_EQ(r.worst_time_s, 4.0);
  ASSERT_TRUE(r.first.has_value());
  EXPECT_DOUBLE_EQ(r.first->time_s, 4.0);
  EXPECT_DOUBLE_EQ(r.first->test, 3.0);
  EXPECT_DOUBLE_EQ(r.first->upper, 2.0);
  EXPECT_DOUBLE_EQ(r.first->lower, -2.0);
  // Two whole intervals outside and two half ones, of ten.
  EXPECT_DOUBLE_EQ(r.fraction_outside, 0.3);
  EXPECT_TRUE(IsOneLine(r.reason));
}

TEST(Tube, EdgeItselfIsInside) {
  const Signal reference = Sampled(5, 1.0, [](double) { return 0.0; });
  const auto at = [&](double level) {
    const Signal test = Sampled(5, 1.0, [=](double) { return level; });
    return CompareTube(reference.View(), test.View(), {.relative_width = 1.0, .nominal = 2.0});
  };
  EXPECT_TRUE(at(2.0).ok());
  EXPECT_DOUBLE_EQ(at(-2.0).worst_ratio, 1.0);
  EXPECT_FALSE(at(std::nextafter(2.0, 3.0)).ok());
}

TEST(Tube, WidthInTimeForgivesAStepThatComesLate) {
  const auto step = [](double at) { return Sampled(101, 0.01, [=](double t) { return t < at ? 0.0 : 1.0; }); };
  for (const Interpolation i : {Interpolation::kLinear, Interpolation::kHold}) {
    const TubeOptions wide{.relative_width = 0.01, .nominal = 1.0, .time_half_width_s = 0.0405};
    EXPECT_TRUE(CompareTube(step(0.5).View(i), step(0.54).View(i), wide).ok());
    EXPECT_TRUE(CompareTube(step(0.5).View(i), step(0.46).View(i), wide).ok());
    EXPECT_FALSE(CompareTube(step(0.5).View(i), step(0.56).View(i), wide).ok());
    EXPECT_FALSE(CompareTube(step(0.5).View(i), step(0.44).View(i), wide).ok());
  }
}

TEST(Tube, TimeBasesMayDifferAndBetweenSamplesTheInterpolationCounts) {
  // A ramp is exact under linear interpolation on any base; a held one is off by one step of its own.
  const Signal fine = Sampled(1001, 0.001, [](double t) { return t; });
  const Signal coarse = Sampled(11, 0.1, [](double t) { return t; });
  const TubeOptions tight{.relative_width = 1e-12, .nominal = 1.0};  // round-off of values up to 1: 1e-16 each
  EXPECT_TRUE(CompareTube(fine.View(), coarse.View(), tight).ok());
  EXPECT_TRUE(CompareTube(coarse.View(), fine.View(), tight).ok());
  const TubeResult held =
      CompareTube(fine.View(), coarse.View(Interpolation::kHold), {.relative_width = 0.05, .nominal = 1.0});
  EXPECT_FALSE(held.ok());
  EXPECT_NEAR(held.worst_ratio, 2.0, 1e-6);  // 0.1 behind at the end of each hold, over 0.05
}

TEST(Tube, ExcursionBetweenTheSamplesOfTheOtherIsSeen) {
  const Signal reference = Sampled(11, 0.1, [](double) { return 0.0; });
  Signal test = Sampled(1001, 0.001, [](double) { return 0.0; });
  test.v[555] = 1.0;  // the reference has no sample within 45 ms
  EXPECT_FALSE(CompareTube(reference.View(), test.View(), {.relative_width = 0.5, .nominal = 1.0}).ok());
  Signal spiky = Sampled(1001, 0.001, [](double) { return 0.0; });
  spiky.v[555] = 1.0;
  const Signal flat = Sampled(11, 0.1, [](double) { return 0.0; });
  EXPECT_FALSE(CompareTube(spiky.View(), flat.View(), {.relative_width = 0.5, .nominal = 1.0}).ok());
}

TEST(Tube, AgreesWithItsDefinitionByBruteForce) {
  std::mt19937_64 random(5);
  std::uniform_real_distribution<double> uniform(0, 1);
  for (int run = 0; run < 30; ++run) {
    Signal reference, test;
    const auto fill = [&](Signal& s, double mean_step) {  // non-uniform, on the span 0 .. 1
      for (double t = 0; t < 1.0; t += mean_step * (0.5 + uniform(random))) {
        s.t.push_back(t);
        s.v.push_back(uniform(random));
      }
      s.t.push_back(1.0);
      s.v.push_back(uniform(random));
    };
    fill(reference, 0.02);
    fill(test, 0.013);
    const double w = 0.05 * uniform(random), h = 0.3;
    const TubeResult r = CompareTube(reference.View(), test.View(),
                                     {.relative_width = h, .nominal = 1.0, .time_half_width_s = w, .max_gap_s = 1.0});
    double worst = 0.0;
    std::vector<double> times = reference.t;
    times.insert(times.end(), test.t.begin(), test.t.end());
    for (double t : times) {
      const double from = std::max(0.0, t - w), to = std::min(1.0, t + w);
      std::vector<double> near = {from};
      for (double s : reference.t)
        if (s > from && s < to) near.push_back(s);
      near.push_back(to);
      const std::vector<double> values = SampleAt(reference.View(), near);
      const auto [low, high] = std::minmax_element(values.begin(), values.end());
      const double y = SampleAt(test.View(), std::vector<double>{t})[0];
      worst = std::max({worst, (y - *high) / h, (*low - y) / h});
    }
    EXPECT_NEAR(r.worst_ratio, worst, 1e-12);  // round-off of interpolation, values up to 1
  }
}

TEST(Tube, TestMustCoverTheReference) {
  const TubeOptions wide{.relative_width = 10.0, .nominal = 1.0, .time_half_width_s = 1.0};
  for (const Bad& bad : Uncovering(Sine())) {
    const TubeResult r = CompareTube(Sine().View(), bad.signal.View(), wide);
    EXPECT_FALSE(r.ok()) << bad.what;
    EXPECT_TRUE(IsOneLine(r.reason));
  }
  Signal longer = Sampled(301, 0.01, [](double t) { return std::sin(2 * kPi * t); });
  EXPECT_TRUE(CompareTube(Sine().View(), longer.View(), wide).ok());
}

TEST(Tube, NothingUnsoundPasses) {
  const TubeOptions wide{.relative_width = 100.0, .nominal = 1.0, .time_half_width_s = 1.0};
  for (const Bad& bad : Gallery(Sine())) {
    for (const TubeResult& r :
         {CompareTube(bad.signal.View(), Sine().View(), wide), CompareTube(Sine().View(), bad.signal.View(), wide),
          CompareTube(bad.signal.View(), bad.signal.View(), wide)}) {
      EXPECT_FALSE(r.ok()) << bad.what;
      EXPECT_TRUE(IsOneLine(r.reason)) << bad.what;
      EXPECT_EQ(TubeCheck(r, "a", "b").verdict, Verdict::kFail);
    }
  }
}

TEST(Tube, WidthsMustMakeSense) {
  const double nan = std::numeric_limits<double>::quiet_NaN(), inf = std::numeric_limits<double>::infinity();
  for (double bad : {nan, inf, -1.0}) {
    EXPECT_FALSE(CompareTube(Sine().View(), Sine().View(), {.relative_width = bad, .nominal = 1.0}).ok());
    EXPECT_FALSE(CompareTube(Sine().View(), Sine().View(), {.relative_width = 1.0, .nominal = bad}).ok());
    EXPECT_FALSE(
        CompareTube(Sine().View(), Sine().View(), {.relative_width = 1.0, .nominal = 1.0, .time_half_width_s = bad})
            .ok());
  }
  EXPECT_FALSE(CompareTube(Sine().View(), Sine().View(), {}).ok());
}

}  // namespace
}  // namespace dynoproof::score
