// Tubes of signals with several rows at one instant: both sides of a jump count, whoever has how many rows.
#include "score/jumps.h"

#include <gtest/gtest.h>

#include <limits>

#include "score/tube.h"
#include "tests/score/signals.h"

namespace dynoproof::score {
namespace {

constexpr double kEvent = 0.5, kEnd = 1.0;

/// A signal of steps of 0.1 s that is `law` but at the event, where it has these rows.
Signal Rows(
    std::vector<double> rows, double event = kEvent,
    const std::function<double(double)>& law = [](double t) { return t < kEvent ? 0.0 : 1.0; }) {
  Signal s;
  for (int i = 0; i <= 10; ++i) {
    const double t = i / 10.0;
    const std::vector<double> here = t == event ? rows : std::vector<double>{law(t)};
    double row_s = t;
    for (const double value : here) {
      s.t.push_back(row_s);
      s.v.push_back(value);
      row_s = std::nextafter(row_s, std::numeric_limits<double>::infinity());
    }
  }
  return s;
}

bool Passes(const Signal& reference, const Signal& test, Interpolation i = Interpolation::kLinear, double room = 2.0) {
  const TubeOptions options{.relative_width = 1e-3, .nominal = 1.0, .max_gap_s = 1.0, .interpolation_room = room};
  return CompareTube(reference.View(i), test.View(i), options).ok();
}

const std::vector<double> kJump = {0, 1}, kTwice = {0, 1, 1}, kBeforeTwice = {0, 0, 1}, kOnItsWay = {0, 0.5, 1};
const std::vector<double> kBefore = {0}, kAfter = {1}, kMiddle = {0.5};
const std::vector<double> kOvershoot = {0, 9, 1}, kWrongBefore = {5, 1}, kWrongAfter = {0, 5}, kBackwards = {1, 0};

TEST(TubeJumps, HoweverManyRowsTellOfOneJump) {
  for (const Interpolation i : {Interpolation::kLinear, Interpolation::kHold}) {
    for (const double room : {0.0, 2.0}) {
      for (const auto& a : {kJump, kTwice, kBeforeTwice, kOnItsWay}) {
        for (const auto& b : {kJump, kTwice, kBeforeTwice, kOnItsWay})
          EXPECT_TRUE(Passes(Rows(a), Rows(b), i, room)) << a.size() << " " << b.size();
      }
    }
  }
}

TEST(TubeJumps, ASingleSampleIsAnyPartOfTheJump) {
  for (const auto& one : {kBefore, kAfter, kMiddle}) {
    for (const auto& rows : {kJump, kTwice, kBeforeTwice, kOnItsWay}) {
      EXPECT_TRUE(Passes(Rows(one), Rows(rows))) << one[0] << " " << rows.size();
      EXPECT_TRUE(Passes(Rows(rows), Rows(one))) << one[0] << " " << rows.size();
    }
  }
}

/// A value that only one of the two has, on either side of the instant or between, as reference and as test.
TEST(TubeJumps, AnotherValueOnEitherSideIsSeen) {
  for (const Interpolation i : {Interpolation::kLinear, Interpolation::kHold}) {
    for (const double room : {0.0, 2.0}) {
      for (const auto& wrong : {kOvershoot, kWrongBefore, kWrongAfter}) {
        EXPECT_TRUE(Passes(Rows(wrong), Rows(wrong), i, room)) << "itself";
        for (const auto& right : {kJump, kTwice, kOnItsWay, kBefore, kAfter}) {
          EXPECT_FALSE(Passes(Rows(right), Rows(wrong), i, room)) << right.size() << " " << wrong[0] << wrong[1];
          EXPECT_FALSE(Passes(Rows(wrong), Rows(right), i, room)) << right.size() << " " << wrong[0] << wrong[1];
        }
      }
      EXPECT_FALSE(Passes(Rows(kJump), Rows(kBackwards), i, room));
    }
  }
  const TubeResult result = CompareTube(Rows(kJump).View(), Rows(kWrongAfter).View(),
                                        {.relative_width = 1e-3, .nominal = 1.0, .interpolation_room = 2.0});
  ASSERT_TRUE(result.first);
  EXPECT_NEAR(result.first->time_s, kEvent, 1e-12);
  EXPECT_EQ(result.first->test, 5.0);
  EXPECT_NEAR(result.first->upper, 1.001, 1e-12);
  EXPECT_NEAR(result.worst_ratio, 4000.0, 1e-6);
}

/// What lies before the first sample or after the last one, only who has a row there tells: the other one may have
/// begun behind the event, or ended before it.
TEST(TubeJumps, AtTheEndsTheInnerSideCounts) {
  const auto rises = [](double t) { return t > 0.0 ? 1.0 : 0.0; };
  for (const bool swap : {false, true}) {
    const auto ok = [swap](const Signal& a, const Signal& b) { return swap ? Passes(b, a) : Passes(a, b); };
    const auto at_start = [&](std::vector<double> rows) { return Rows(std::move(rows), 0.0, rises); };
    EXPECT_TRUE(ok(at_start(kJump), at_start(kAfter)));
    EXPECT_FALSE(ok(at_start(kWrongAfter), at_start(kAfter)));
    EXPECT_FALSE(ok(at_start(kJump), at_start(kWrongBefore)));
    EXPECT_FALSE(ok(at_start(kJump), at_start(kWrongAfter)));
    const auto at_end = [&](std::vector<double> rows) {
      return Rows(std::move(rows), kEnd, [](double) { return 0.0; });
    };
    EXPECT_TRUE(ok(at_end(kJump), at_end(kBefore)));
    EXPECT_TRUE(ok(at_end(kJump), at_end(kTwice)));
    EXPECT_FALSE(ok(at_end(kWrongBefore), at_end(kAfter)));
    EXPECT_FALSE(ok(at_end(kJump), at_end(kWrongBefore)));
    EXPECT_FALSE(ok(at_end(kJump), at_end(kWrongAfter)));
    EXPECT_FALSE(ok(at_end(kJump), at_end({0, 0, 5})));
  }
}

/// A saw tooth against a raster that misses its jump or has one sample there: the rows lie on the lines that its samples
/// tell, not between them.
TEST(TubeJumps, ARasterWithoutTheRowsIsContinuedToThem) {
  const auto tooth = [](double t) { return t < kEvent ? 10.0 * t : 10.0 * (t - 1.0); };
  const Signal rows = Rows({5, -5}, kEvent, tooth);
  for (const Signal& raster :
       {Sampled(34, 1.0 / 33.0, tooth), Sampled(41, 0.025, tooth), Sampled(401, 0.0025, tooth)}) {
    EXPECT_TRUE(Passes(rows, raster));
    EXPECT_TRUE(Passes(raster, rows));
    for (const std::vector<double>& wrong : {std::vector<double>{5.5, -5}, {5, -5.5}, {5, 9, -5}}) {
      EXPECT_FALSE(Passes(Rows(wrong, kEvent, tooth), raster));
      EXPECT_FALSE(Passes(raster, Rows(wrong, kEvent, tooth)));
    }
  }
}

TEST(TubeJumps, MayComeEarlyOrLateWithinAWidthInTime) {
  const auto at = [](double event) { return Rows(kJump, event, [event](double t) { return t < event ? 0.0 : 1.0; }); };
  const auto ok = [](const Signal& a, const Signal& b, double w) {
    return CompareTube(a.View(), b.View(), {.relative_width = 1e-3, .nominal = 1.0, .time_half_width_s = w}).ok();
  };
  EXPECT_TRUE(ok(at(0.5), at(0.4), 0.11));
  EXPECT_TRUE(ok(at(0.5), at(0.6), 0.11));
  EXPECT_FALSE(ok(at(0.5), at(0.4), 0.05));
  EXPECT_FALSE(ok(at(0.5), Rows(kWrongAfter), 0.11));
  EXPECT_FALSE(ok(at(0.5), Rows(kWrongBefore), 0.11));
}

}  // namespace
}  // namespace dynoproof::score
