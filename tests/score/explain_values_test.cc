// What explanations say: magnitudes by hand, events, ambiguity, other time bases, and what must never pass.
#include <gtest/gtest.h>

#include <algorithm>

#include "score/align.h"
#include "score/explain.h"
#include "tests/score/signals.h"

namespace dynoproof::score {
namespace {

double Law(double t) {
  return 2.0 + std::sin(2 * kPi * 3 * t) + 0.6 * std::sin(2 * kPi * 7.3 * t + 1) * std::cos(1.7 * t);
}
Signal Reference() { return Sampled(2000, 1e-3, Law); }

TEST(Explain, MagnitudesByHand) {
  const auto ask = [](const std::function<double(double)>& law) {
    return Explain(Reference().View(), Sampled(2000, 1e-3, law).View(), {.unit = "Nm"});
  };
  Explanation e = ask([](double t) { return Law(t - 0.00213); });
  EXPECT_EQ(e.cause, Cause::kShift);
  EXPECT_NEAR(e.magnitude, 0.00213, 1e-6);  // a thousandth of a sample, see FitGainOffsetShift
  EXPECT_EQ(e.unit, "s");
  EXPECT_EQ(e.text, "late by 2.13 ms (explains 100 % of the difference)");
  e = ask([](double t) { return 1.1 * Law(t); });
  EXPECT_EQ(e.cause, Cause::kGain);
  EXPECT_NEAR(e.magnitude, 1.1, 1e-12);
  e = ask([](double t) { return Law(t) - 3.0; });
  EXPECT_EQ(e.cause, Cause::kOffset);
  EXPECT_NEAR(e.magnitude, -3.0, 1e-12);
  EXPECT_EQ(e.text, "offset -3 Nm (explains 100 % of the difference)");
  EXPECT_GT(e.explained, 0.999999);
  e = ask([](double t) { return Law(t) + 0.5 * t; });
  EXPECT_EQ(e.cause, Cause::kDrift);
  EXPECT_NEAR(e.magnitude, 0.5, 1e-12);
  EXPECT_EQ(e.unit, "Nm/s");
  e = ask([](double t) { return Law(t) + 0.7 * std::exp(-t / 0.1); });
  EXPECT_EQ(e.cause, Cause::kStartValue);
  EXPECT_NEAR(e.magnitude, 0.7, 1e-4);
  EXPECT_NEAR(e.quantities[1].value, 0.1, 1e-4);
  e = ask([](double t) { return -Law(t); });
  EXPECT_EQ(e.cause, Cause::kSignFlip);
  e = ask([](double t) { return t < 1.2 ? Law(t) : Law(t) + 0.2 + 0.1 * std::sin(33 * t * t); });
  EXPECT_EQ(e.cause, Cause::kDivergence);
  EXPECT_NEAR(e.magnitude, 1.2, 2e-3);
  e = ask(Law);
  EXPECT_EQ(e.cause, Cause::kIdentical);
}

TEST(Explain, WhatTheSignalCannotTellApartIsListed) {
  // On a straight ramp a delay and an offset are the same thing.
  const Signal ramp = Sampled(1000, 1e-3, [](double t) { return 5.0 * t; });
  const Signal late = Sampled(1000, 1e-3, [](double t) { return 5.0 * (t - 0.01); });
  const Explanation e = Explain(ramp.View(), late.View());
  std::vector<Cause> named = e.alternatives;
  named.push_back(e.cause);
  EXPECT_NE(std::find(named.begin(), named.end(), Cause::kShift), named.end()) << e.text;
  EXPECT_NE(std::find(named.begin(), named.end(), Cause::kOffset), named.end()) << e.text;
}

TEST(Explain, OtherAndUnevenTimeBases) {
  const Signal coarse = Sampled(801, 2.5e-3, [](double t) { return 1.2 * Law(t); });
  Explanation e = Explain(Sampled(1999, 1e-3, Law).View(), coarse.View());
  EXPECT_EQ(e.cause, Cause::kGain) << e.text;
  EXPECT_NEAR(e.magnitude, 1.2, 0.002);  // linear interpolation at 7.3 Hz and 2.5 ms: (w h)^2 / 12
  Signal uneven;
  for (double t = 0; t < 2.0; t += 1e-3 * (1.0 + 0.5 * std::sin(50 * t))) {
    uneven.t.push_back(t);
    uneven.v.push_back(Law(t));
  }
  Signal more = uneven;
  for (double& v : more.v) v += 0.3;
  e = Explain(uneven.View(), more.View());
  EXPECT_EQ(e.cause, Cause::kOffset) << e.text;
}

// Three bumps, each following its event.
double Bumps(double t, const std::vector<double>& at, const std::vector<double>& height) {
  double sum = 0.0;
  for (std::size_t i = 0; i < at.size(); ++i)
    sum += t > at[i] ? height[i] * std::exp(-(t - at[i]) / 0.1) * std::sin(40 * (t - at[i])) : 0.0;
  return sum;
}

TEST(Explain, EventsShiftedSwappedAndMissing) {
  const std::vector<double> at = {0.5, 1.0, 1.5}, moved = {0.52, 0.95, 1.53};
  const Signal reference = Sampled(2000, 1e-3, [&](double t) { return Bumps(t, at, {1, 2, 3}); });
  const std::vector<Event> events = {{0.5, "a"}, {1.0, "b"}, {1.5, "c"}};
  {
    const std::vector<Event> late = {{0.52, "a"}, {0.95, "b"}, {1.53, "c"}};
    const Signal test = Sampled(2000, 1e-3, [&](double t) { return Bumps(t, moved, {1, 2, 3}); });
    const Explanation e = Explain(reference.View(), test.View(), {.reference_events = events, .test_events = late});
    EXPECT_EQ(e.cause, Cause::kEventsShifted) << e.text;
    EXPECT_NEAR(e.magnitude, -0.05, 1e-9);
    const Explanation without = Explain(reference.View(), test.View());
    EXPECT_NE(without.cause, Cause::kEventsShifted);
  }
  {
    const std::vector<Event> swapped = {{0.5, "a"}, {1.0, "c"}, {1.5, "b"}};
    const Signal test = Sampled(2000, 1e-3, [&](double t) { return Bumps(t, at, {1, 3, 2}); });
    const Explanation e = Explain(reference.View(), test.View(), {.reference_events = events, .test_events = swapped});
    EXPECT_EQ(e.cause, Cause::kEventsReordered) << e.text;
    EXPECT_NEAR(e.magnitude, 1.0, 1e-9);
  }
  {
    const std::vector<Event> fewer = {{0.5, "a"}, {1.5, "c"}};
    const Signal test = Sampled(2000, 1e-3, [&](double t) { return Bumps(t, at, {1, 0, 3}); });
    const Explanation e = Explain(reference.View(), test.View(), {.reference_events = events, .test_events = fewer});
    EXPECT_EQ(e.cause, Cause::kEventsMissing) << e.text;
  }
  {  // events that differ are no excuse for signals that differed before
    const std::vector<Event> fewer = {{0.5, "a"}, {1.0, "b"}};
    const Signal test = Sampled(2000, 1e-3, [&](double t) {
      return Bumps(t, at, {1, 2, 3}) + 0.3 * std::sin(9 * t * t);
    });
    EXPECT_EQ(Explain(reference.View(), test.View(), {.reference_events = events, .test_events = fewer}).cause,
              Cause::kNone);
  }
}

TEST(Explain, NothingUnsoundPasses) {
  const Signal good = Reference();
  const auto refused = [](const Explanation& e, const std::string& what) {
    EXPECT_FALSE(e.ok()) << what;
    EXPECT_EQ(e.cause, Cause::kNone) << what;
    EXPECT_TRUE(IsOneLine(e.text) && IsOneLine(e.reason)) << what;
  };
  for (const Bad& bad : Gallery(good)) {
    refused(Explain(bad.signal.View(), good.View()), bad.what);
    refused(Explain(good.View(), bad.signal.View()), bad.what);
  }
  for (const Bad& bad : Uncovering(good)) refused(Explain(good.View(), bad.signal.View()), bad.what);
  const std::vector<Event> broken = {{std::numeric_limits<double>::quiet_NaN(), "a"}}, backwards = {{2, "a"}, {1, "b"}};
  refused(Explain(good.View(), good.View(), {.reference_events = broken}), "NaN event");
  refused(Explain(good.View(), good.View(), {.test_events = backwards}), "events backwards");
  refused(Explain(good.View(), good.View(), {.least_explained = 0.1}), "too lenient");
}

TEST(Explain, ConstantReferenceIsNoTrouble) {
  const Signal flat = Sampled(500, 1e-3, [](double) { return 4.0; });
  EXPECT_EQ(Explain(flat.View(), Sampled(500, 1e-3, [](double) { return 4.5; }).View()).cause, Cause::kOffset);
  const Signal zero = Sampled(500, 1e-3, [](double) { return 0.0; });
  EXPECT_EQ(Explain(zero.View(), Sampled(500, 1e-3, [](double t) { return std::sin(60 * t); }).View()).cause,
            Cause::kNone);
}

}  // namespace
}  // namespace dynoproof::score
