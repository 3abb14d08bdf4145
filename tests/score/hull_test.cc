// Hull curves: accuracy on sines and chirps, errors by hand, and what must never pass.
#include "score/hull.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "score/response.h"
#include "tests/score/signals.h"

namespace dynoproof::score {
namespace {

TEST(Hull, OfASineIsItsAmplitudeWithinTheParabola) {
  // Header: within 0.6 % from 9 samples per period on; the plain samples would be up to 6 % too small.
  for (double per_period : {9.3, 12.7, 31.9, 100.3}) {
    const Signal s = Sampled(2000, 1.0 / per_period, [](double t) { return 3.0 + 2.0 * std::sin(2 * kPi * t + 0.4); });
    const HullCurve hull = Hull(s.View(), 2.5);
    ASSERT_TRUE(hull.ok()) << hull.reason;
    for (std::size_t i = 300; i < 1700; ++i) {
      EXPECT_NEAR(hull.upper[i], 5.0, 0.006 * 2.0) << per_period;
      EXPECT_NEAR(hull.lower[i], 1.0, 0.006 * 2.0) << per_period;
    }
  }
}

TEST(Hull, WithoutOscillationBetweenSamplesIsThePlainMaximum) {
  // Alternating samples are no well-sampled peaks: they stay as they are.
  const Signal s = Sampled(9, 1.0, [](double t) { return std::fmod(t, 2.0) < 0.5 ? 1.0 : -1.0; });
  const HullCurve hull = Hull(s.View(), 2.0);
  for (std::size_t i = 0; i < 9; ++i) {
    EXPECT_EQ(hull.upper[i], 1.0);
    EXPECT_EQ(hull.lower[i], -1.0);
  }
}

TEST(Hull, AdaptiveWindowFollowsAChirp) {
  // Amplitude 1 + t/4 while the frequency goes from 1 to 101 Hz in 4 s: a fixed window fits only one of the two ends.
  const double rate = 25.0;
  const auto amplitude = [](double t) { return 1.0 + 0.25 * t; };
  const Signal s =
      Sampled(8001, 0.0005, [&](double t) { return amplitude(t) * std::sin(2 * kPi * (t + 0.5 * rate * t * t)); });
  const std::vector<double> f = ChirpFrequency(s.t, 1.0, rate);
  const HullCurve hull = AdaptiveHull(s.View(), f, 1.5, 1.0);
  ASSERT_TRUE(hull.ok()) << hull.reason;
  for (std::size_t i = 1000; i < 7900; ++i) {
    const double half_window = 0.75 / f[i];
    // The largest amplitude within the window bounds it above; a period has a peak within the window below.
    EXPECT_LE(hull.upper[i], amplitude(s.t[i] + half_window) * 1.006);
    EXPECT_GE(hull.upper[i], amplitude(s.t[i] - half_window) * 0.994);
  }
}

TEST(Hull, ErrorByHand) {
  HullCurve reference;
  reference.verdict = Verdict::kPass;
  reference.time_s = {0, 1, 2, 3};
  reference.upper = {1, 4, 1, 0.1};
  reference.lower = {-1, -4, -1, -0.1};
  HullCurve test = reference;
  test.upper[2] = 1.2;   // 0.2 of a local 1, of a largest 4: 5 %
  test.lower[3] = -0.2;  // 100 % locally, but the hull is not significant there
  const HullError e = CompareHulls(reference, test, {.global = 0.06, .local = 0.25, .significant = 0.1});
  EXPECT_TRUE(e.ok()) << e.reason;
  EXPECT_DOUBLE_EQ(e.largest_half_height, 4.0);
  EXPECT_NEAR(e.global, 0.05, 1e-15);
  EXPECT_EQ(e.global_time_s, 2.0);
  EXPECT_NEAR(e.local, 0.2, 1e-15);
  EXPECT_FALSE(CompareHulls(reference, test, {.global = 0.04, .local = 0.25}).ok());
  EXPECT_FALSE(CompareHulls(reference, test, {.global = 0.06, .local = 0.15}).ok());
  EXPECT_FALSE(CompareHulls(reference, test, {.global = 0.06, .local = 0.25, .significant = 0.01}).ok());
  EXPECT_EQ(HullCheck(e, {.global = 0.06}, "a", "b").verdict, Verdict::kPass);
}

TEST(Hull, ReferenceThatDoesNotOscillateFails) {
  const Signal flat = Sampled(100, 0.01, [](double) { return 2.0; });
  const HullCurve hull = Hull(flat.View(), 0.1);
  EXPECT_TRUE(hull.ok());
  EXPECT_FALSE(CompareHulls(hull, hull, {.global = 1.0}).ok());
}

TEST(Hull, NothingUnsoundPasses) {
  const Signal good = Sampled(200, 0.01, [](double t) { return std::sin(20 * t); });
  const HullCurve fine = Hull(good.View(), 0.5);
  for (const Bad& bad : Gallery(good)) {
    const HullCurve fixed = Hull(bad.signal.View(), 0.5);
    const HullCurve adaptive = AdaptiveHull(bad.signal.View(), std::vector<double>(bad.signal.v.size(), 3.0), 1.5, 0.5);
    for (const HullCurve& hull : {fixed, adaptive}) {
      EXPECT_FALSE(hull.ok()) << bad.what;
      EXPECT_TRUE(IsOneLine(hull.reason)) << bad.what;
      EXPECT_FALSE(CompareHulls(hull, fine, {.global = 1e6}).ok());
      EXPECT_FALSE(CompareHulls(fine, hull, {.global = 1e6}).ok());
    }
  }
  for (const Bad& bad : Uncovering(good))
    EXPECT_FALSE(CompareHulls(fine, Hull(bad.signal.View(), 0.5), {.global = 1e6}).ok());
  EXPECT_FALSE(CompareHulls({}, {}, {.global = 1.0}).ok());
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(CompareHulls(fine, fine, {.global = nan}).ok());
  EXPECT_FALSE(CompareHulls(fine, fine, {}).ok());
  for (double window : {nan, 0.0, -1.0, 1e9, std::numeric_limits<double>::infinity()}) {
    EXPECT_FALSE(Hull(good.View(), window).ok());
    EXPECT_FALSE(AdaptiveHull(good.View(), std::vector<double>(200, 3.0), 1.5, window).ok());
  }
  std::vector<double> f(200, 3.0);
  f[7] = nan;
  EXPECT_FALSE(AdaptiveHull(good.View(), f, 1.5, 0.5).ok());
  EXPECT_FALSE(AdaptiveHull(good.View(), std::vector<double>(199, 3.0), 1.5, 0.5).ok());
}

}  // namespace
}  // namespace dynoproof::score
