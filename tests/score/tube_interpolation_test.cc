// Tubes with room for what lies between samples: two rasters of one course agree, and nothing else does.
#include <gtest/gtest.h>

#include "score/tube.h"
#include "tests/score/signals.h"

namespace dynoproof::score {
namespace {

/// The default width of golden signals, far below what a straight line between coarse samples is off by.
TubeOptions Tight(double room = 2.0) {
  return {.relative_width = 1e-7, .nominal = 1.0, .max_gap_s = 2.0, .interpolation_room = room};
}

double Course(double t) { return std::sin(6.0 * kPi * t) + 0.1 * t; }

/// Steps from 0.2 to 1.8 of `mean`, as an adaptive integrator takes them.
Signal Uneven(double mean_s, const std::function<double(double)>& law) {
  std::mt19937_64 random(7);
  Signal s;
  for (double t = 0.0; t < 2.0; t += mean_s * (0.2 + 1.6 * static_cast<double>(random() >> 11) * 0x1p-53)) {
    s.t.push_back(t);
    s.v.push_back(law(t));
  }
  s.t.push_back(2.0);
  s.v.push_back(law(2.0));
  return s;
}

TEST(TubeBetweenSamples, TwoRastersOfOneCourseAgree) {
  const Signal fine = Sampled(2001, 0.001, Course), coarse = Sampled(201, 0.01, Course);
  for (const Signal& other : {coarse, Uneven(0.007, Course), Uneven(0.0013, Course)}) {
    EXPECT_FALSE(CompareTube(fine.View(), other.View(), Tight(0.0)).ok()) << "the line alone is off";
    EXPECT_TRUE(CompareTube(fine.View(), other.View(), Tight()).ok());
    EXPECT_TRUE(CompareTube(other.View(), fine.View(), Tight()).ok());
    EXPECT_TRUE(CompareTube(coarse.View(), other.View(), Tight()).ok());
  }
}

/// Whatever is off by more than a coarse raster leaves open is seen, wherever it lies.
TEST(TubeBetweenSamples, DeviationsAreSeenAtSamplesOfEitherSignal) {
  const Signal coarse = Sampled(201, 0.01, Course);
  int seen = 0, all = 0;
  for (std::size_t at = 1; at < 2000; at += 37, ++all) {
    Signal fine = Sampled(2001, 0.001, Course);
    fine.v[at] += 0.05;  // the line between coarse samples is off by up to 0.0044
    EXPECT_FALSE(CompareTube(coarse.View(), fine.View(), Tight()).ok()) << "of the test, at " << fine.t[at];
    seen += CompareTube(fine.View(), coarse.View(), Tight()).ok() ? 0 : 1;
  }
  EXPECT_EQ(seen, all) << "of the reference";
  // A gain of one part in a thousand shows at the samples that both have.
  const Signal larger = Sampled(2001, 0.001, [](double t) { return 1.001 * Course(t); });
  EXPECT_FALSE(CompareTube(coarse.View(), larger.View(), Tight()).ok());
}

TEST(TubeBetweenSamples, AHeldSignalMayJumpAnywhereInAStepOfTheCoarserOne) {
  const auto held = [](double at) { return [at](double t) { return t < at ? 1.0 : 3.0; }; };
  const Signal coarse = Sampled(21, 0.1, held(0.75)), fine = Sampled(2001, 0.001, held(0.75));
  const auto ok = [](const Signal& reference, const Signal& test) {
    return CompareTube(reference.View(Interpolation::kHold), test.View(Interpolation::kHold), Tight()).ok();
  };
  EXPECT_TRUE(ok(coarse, fine));
  EXPECT_TRUE(ok(fine, coarse));
  EXPECT_FALSE(ok(coarse, Sampled(2001, 0.001, held(0.95)))) << "a step late";
  EXPECT_FALSE(ok(Sampled(2001, 0.001, held(0.95)), coarse));
  Signal pulse = fine;
  pulse.v[1555] = 3.1;
  EXPECT_FALSE(ok(coarse, pulse));
  EXPECT_FALSE(ok(pulse, coarse));
}

TEST(TubePart, IsJudgedAloneWithWhatLiesBeyondIt) {
  const Signal reference = Sampled(201, 0.01, Course);
  Signal test = Sampled(301, 0.005, Course);  // from 0 to 1.5 s
  TubeOptions part = Tight();
  EXPECT_FALSE(CompareTube(reference.View(), test.View(), part).ok()) << "it ends early";
  part.to_s = 1.5;
  EXPECT_TRUE(CompareTube(reference.View(), test.View(), part).ok());
  test.v[10] += 1.0;
  EXPECT_FALSE(CompareTube(reference.View(), test.View(), part).ok());
  part.from_s = 0.1025;
  const TubeResult r = CompareTube(reference.View(), test.View(), part);
  EXPECT_TRUE(r.ok()) << r.reason;
  EXPECT_NEAR(r.from_s, 0.105, 1e-12);
  EXPECT_EQ(r.to_s, test.t.back());
  part.from_s = part.to_s = 5.0;
  EXPECT_FALSE(CompareTube(reference.View(), test.View(), part).ok()) << "nothing is no part";
}

TEST(TubeBetweenSamples, AnUnsoundRoomIsRefused) {
  const Signal signal = Sampled(11, 0.1, Course);
  for (const double room : {-1.0, std::numeric_limits<double>::quiet_NaN()}) {
    EXPECT_FALSE(CompareTube(signal.View(), signal.View(), Tight(room)).ok());
  }
}

}  // namespace
}  // namespace dynoproof::score
