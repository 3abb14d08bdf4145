// The state machine: each rule by a signal that breaks this one and keeps the others.
#include "control10k/suppression.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <numbers>

namespace control10k {
namespace {

using Signal = std::function<double(double)>;

Signal Tone(double f, double a) {
  return [f, a](double t) { return a * std::sin(2 * std::numbers::pi * f * t); };
}
Signal operator+(const Signal& a, const Signal& b) {
  return [a, b](double t) { return a(t) + b(t); };
}

/// A suppression fed with a signal that does not react.
class Fed {
 public:
  explicit Fed(SuppressionConfig config = {}) : suppression_(config) { suppression_.Start(state); }
  /// `blocks` further blocks; the outcome of the last.
  Outcome Feed(const Signal& signal, int blocks, bool adapt = true) {
    for (int i = 0; i < blocks * suppression_.config().block; ++i) {
      output = suppression_.Step(state, signal(static_cast<double>(n_) * 1e-4), adapt);
      ++n_;
    }
    return static_cast<Outcome>(state.outcome);
  }
  SuppressionState state;
  double output = 0.0;

 private:
  Suppression suppression_;
  long n_ = 0;
};

TEST(Suppression, PlacesASteadyTone) {
  Fed fed;
  EXPECT_EQ(fed.Feed(Tone(832.0, 100.0), 10), Outcome::kMoving);
  EXPECT_EQ(fed.Feed(Tone(832.0, 100.0), 1), Outcome::kPlaced);  // 10 differences are 11 results
  EXPECT_NEAR(fed.state.f_Hz[0], 832.0, 0.7);
  EXPECT_NEAR(fed.state.eta_Nm[0], 100.0, 1.0);
  EXPECT_EQ(fed.state.f_Hz[1], 1500.0);
  EXPECT_EQ(fed.state.eta_Nm[1], 0.0);
  EXPECT_EQ(fed.state.placements, 1.0);
  EXPECT_NEAR(fed.state.notch[0].nu_0, 2 * std::numbers::pi * fed.state.f_Hz[0] * 1e-4, 1e-12);
}

TEST(Suppression, TheHistoryIsClearedByAPlacement) {
  Fed fed;
  fed.Feed(Tone(832.0, 100.0), 21);
  EXPECT_EQ(fed.state.placements, 1.0);
  fed.Feed(Tone(832.0, 100.0), 1);  // another 11 results: the tone is still there, so the second filter takes it
  EXPECT_EQ(fed.state.placements, 2.0);
}

TEST(Suppression, Condition1Magnitude) {
  EXPECT_EQ(Fed().Feed(Tone(832.0, 19.5), 30), Outcome::kQuiet);
  EXPECT_EQ(Fed().Feed(Tone(832.0, 20.5), 11), Outcome::kPlaced);
}

TEST(Suppression, Condition2EdgesAndBand) {
  EXPECT_EQ(Fed().Feed([](double) { return 500.0; }, 30), Outcome::kEdge);
  EXPECT_EQ(Fed().Feed(Tone(140.0, 100.0), 30), Outcome::kEdge);   // bin 2, below f_min
  EXPECT_EQ(Fed().Feed(Tone(1850.0, 100.0), 30), Outcome::kEdge);  // bin 24
  EXPECT_EQ(Fed().Feed(Tone(1810.0, 100.0), 30), Outcome::kEdge);  // bin 23, above f_max
  // A steady torque hides an oscillation of less than its share of bin 1: 0.25 / 0.42 of twice the torque.
  EXPECT_EQ(Fed().Feed(
                Tone(832.0, 100.0) + [](double) { return 100.0; }, 30),
            Outcome::kEdge);
  EXPECT_EQ(Fed().Feed(
                Tone(832.0, 130.0) + [](double) { return 100.0; }, 11),
            Outcome::kPlaced);
}

TEST(Suppression, Condition3OneToneOnly) {
  EXPECT_EQ(Fed().Feed(Tone(832.0, 100.0) + Tone(940.0, 40.0), 30), Outcome::kMixed);
  EXPECT_EQ(Fed().Feed(Tone(832.0, 100.0) + Tone(1200.0, 90.0), 11), Outcome::kPlaced);  // far enough apart
}

TEST(Suppression, Condition3TakesCleanTonesEverywhere) {
  for (double f = 170.0; f < 1780.0; f += 7.3) {
    EXPECT_EQ(Fed().Feed(Tone(f, 100.0), 11), Outcome::kPlaced) << f;
  }
  SuppressionConfig strict;
  strict.far_lobe_tolerance = 0.05;
  EXPECT_EQ(Fed(strict).Feed(Tone((8 + 0.48) * 78.125, 100.0), 30), Outcome::kMixed);
}

TEST(Suppression, Condition4SteadyFrequency) {
  const Signal sweep = [](double t) {
    return 100.0 * std::sin(2 * std::numbers::pi * (600.0 * t + 0.5 * 100.0 * t * t));
  };
  EXPECT_EQ(Fed().Feed(sweep, 40), Outcome::kMoving);  // 100 Hz/s: 12.8 Hz in ten blocks
  const Signal slow = [](double t) {
    return 100.0 * std::sin(2 * std::numbers::pi * (600.0 * t + 0.5 * 40.0 * t * t));
  };
  EXPECT_EQ(Fed().Feed(slow, 11), Outcome::kPlaced);
}

TEST(Suppression, Category2TakesTheWeakestOrRefuses) {
  Fed fed;
  fed.Feed(Tone(832.0, 200.0), 11);
  fed.Feed(Tone(606.0, 50.0), 11);
  ASSERT_EQ(fed.state.placements, 2.0);
  EXPECT_EQ(fed.Feed(Tone(1000.0, 30.0), 30), Outcome::kWeaker);
  EXPECT_EQ(fed.Feed(Tone(1000.0, 60.0), 1), Outcome::kPlaced);
  EXPECT_NEAR(fed.state.f_Hz[1], 1000.0, 0.7);
  EXPECT_NEAR(fed.state.f_Hz[0], 832.0, 0.7);
}

TEST(Suppression, DecayFollows537DownToItsFloor) {
  SuppressionConfig config;
  config.alpha = 0.9999;
  Fed fed(config);
  fed.Feed(Tone(832.0, 200.0), 11);
  const double eta = fed.state.eta_Nm[0];
  fed.Feed([](double) { return 0.0; }, 10);
  EXPECT_NEAR(fed.state.eta_Nm[0], eta * std::pow(0.9999, 1280), eta * 1e-12);
  fed.Feed([](double) { return 0.0; }, 400);
  EXPECT_EQ(fed.state.eta_Nm[0], 1.1 * 20.0);
  EXPECT_EQ(fed.state.eta_Nm[1], 0.0);  // an unused filter stays unused
}

TEST(Suppression, AdaptationOffNeitherCollectsNorForgetsTheFilters) {
  Fed fed;
  EXPECT_EQ(fed.Feed(Tone(832.0, 100.0), 30, false), Outcome::kNone);
  EXPECT_EQ(fed.state.placements, 0.0);
  fed.Feed(Tone(832.0, 100.0), 11);
  ASSERT_EQ(fed.state.placements, 1.0);
  const double eta = fed.state.eta_Nm[0];
  fed.Feed(Tone(832.0, 100.0), 50, false);
  EXPECT_EQ(fed.state.eta_Nm[0], eta);
  // It still filters: a notch that is 0.64 Hz off leaves 0.64 / 8 of the tone, 8 Hz being its half width.
  EXPECT_LT(std::abs(fed.output), 8.0);
}

TEST(Suppression, AProbeThatMovesNothingIsTakenBack) {
  SuppressionConfig config;
  config.probe_gamma = 0.0005;
  Fed fed(config);
  fed.Feed(Tone(832.0, 100.0), 11);
  EXPECT_GE(fed.state.probe, 0.0);
  EXPECT_EQ(fed.Feed(Tone(832.0, 100.0), 4), Outcome::kRefused);  // a load: its frequency does not react
  EXPECT_EQ(fed.state.placements, 0.0);
  fed.Feed(Tone(832.0, 100.0), 1);
  for (int i = 0; i < 3; ++i) EXPECT_EQ(fed.state.notch[i].r, 1.0);
}

TEST(Suppression, AProbeThatEndsTheOscillationStays) {
  SuppressionConfig config;
  config.probe_gamma = 0.0005;
  Fed fed(config);
  fed.Feed(Tone(832.0, 100.0), 11);
  fed.Feed(Tone(832.0, 100.0), 1);
  EXPECT_EQ(fed.Feed([](double) { return 0.0; }, 1), Outcome::kPlaced);
  EXPECT_NEAR(fed.state.f_Hz[0], 832.0, 0.7);
  EXPECT_EQ(fed.state.notch[0].r, 0.9995);
}

TEST(Suppression, RefusesUnusableConfigs) {
  EXPECT_TRUE(IsUsable(SuppressionConfig()));
  const auto bad = [](auto change) {
    SuppressionConfig config;
    change(config);
    return !IsUsable(config);
  };
  EXPECT_TRUE(bad([](auto& c) { c.notches = 0; }));
  EXPECT_TRUE(bad([](auto& c) { c.notches = kMaxNotches; }));
  EXPECT_TRUE(bad([](auto& c) { c.radius = 1.01; }));
  EXPECT_TRUE(bad([](auto& c) { c.initial_Hz = 5000.0; }));
  EXPECT_TRUE(bad([](auto& c) { c.block = 5000; }));
  EXPECT_TRUE(bad([](auto& c) { c.f_min_Hz = 1900.0; }));
  EXPECT_TRUE(bad([](auto& c) { c.steady = kMaxSteady; }));
  EXPECT_TRUE(bad([](auto& c) { c.alpha = 1.1; }));
  EXPECT_TRUE(bad([](auto& c) { c.T_min_Nm = std::nan(""); }));
}

}  // namespace
}  // namespace control10k
