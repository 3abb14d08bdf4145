// Frequency responses out of chirp records, their peaks, and the comparison of peak lists.
#include "score/peaks.h"

#include <gtest/gtest.h>

#include "score/response.h"
#include "tests/score/signals.h"

namespace dynoproof::score {
namespace {

struct Mode {
  double hz, zeta;
};

// Exact sampled response of 1 / (s^2 + 2 zeta w s + w^2) * w^2 to an input held between samples.
std::vector<double> Respond(const Mode& m, const std::vector<double>& u, double step) {
  const double w = 2 * kPi * m.hz, wd = w * std::sqrt(1 - m.zeta * m.zeta), e = std::exp(-m.zeta * w * step);
  const double c = std::cos(wd * step), s = std::sin(wd * step), q = m.zeta * w / wd;
  std::vector<double> y(u.size());
  double p = 0.0, v = 0.0;
  for (std::size_t i = 0; i < u.size(); ++i) {
    y[i] = p;
    const double x = p - u[i];
    p = u[i] + e * (x * (c + q * s) + v * s / wd);
    v = e * (v * (c - q * s) - x * w * w / wd * s);
  }
  return y;
}

double Gain(const Mode& m, double hz) {
  const double r = hz / m.hz;
  return 1.0 / std::hypot(1 - r * r, 2 * m.zeta * r);
}

constexpr double kStep = 1e-3;

// 0 to 120 Hz in 20 s, then rest until everything has rung down.
Signal Chirp() {
  return Sampled(26000, kStep, [](double t) { return t < 20.0 ? 100.0 * std::sin(2 * kPi * 3.0 * t * t) : 0.0; });
}

TEST(Response, OfOneModeIsItsClosedForm) {
  const Mode mode{40.0, 0.02};
  const Signal u = Chirp();
  std::vector<double> y = Respond(mode, u.v, kStep);
  for (double& v : y) v += 700.0;  // a constant load must not matter
  const Response r = EstimateResponse(u.t, u.v, y, {.from_hz = 5, .to_hz = 115});
  ASSERT_TRUE(r.ok()) << r.reason;
  const std::vector<double> magnitude = r.Magnitude();
  for (std::size_t i = 0; i < magnitude.size(); ++i) {
    // A held input adds a factor sinc(f dt), 2 % at 115 Hz; smoothing over 0.15 Hz of a peak 1.6 Hz wide takes up to 1
    // %.
    EXPECT_NEAR(magnitude[i] / Gain(mode, r.frequency_hz[i]), 1.0, 0.03) << r.frequency_hz[i];
    EXPECT_GT(r.coherence[i], 0.95) << r.frequency_hz[i];
  }
  const PeakList peaks = FindPeaks(r.frequency_hz, magnitude, 6.0);
  ASSERT_EQ(peaks.peaks.size(), 1U);
  EXPECT_NEAR(peaks.peaks[0].frequency_hz, 40.0 * std::sqrt(1 - 2 * 0.02 * 0.02), 0.04);  // a quarter of the smoothing
  EXPECT_NEAR(peaks.peaks[0].height, Gain(mode, 40.0), 0.02 * 25);                        // smoothing, see above
  ASSERT_TRUE(peaks.peaks[0].damping_ratio.has_value());
  EXPECT_NEAR(*peaks.peaks[0].damping_ratio, 0.02, 0.04 * 0.02);  // smoothing widens by about 2 (0.15/1.6)^2
}

TEST(Response, FrequencyMapsGoBothWays) {
  const Signal u = Chirp();
  const std::vector<double> f = ChirpFrequency(u.t, 10.0, 6.0);
  EXPECT_DOUBLE_EQ(f[0], 10.0);
  EXPECT_NEAR(f[5000], 40.0, 1e-9);
  EXPECT_NEAR(TimeOfFrequency(u.t, f, 40.0), 5.0, 1e-9);
  EXPECT_TRUE(std::isnan(TimeOfFrequency(u.t, f, 9.0)));
}

TEST(Response, UnexcitedBandAndBadInputFail) {
  const Signal u = Chirp();
  const std::vector<double> y = Respond({40, 0.02}, u.v, kStep);
  EXPECT_FALSE(EstimateResponse(u.t, u.v, y, {.from_hz = 5, .to_hz = 300}).ok());  // the chirp ends at 120 Hz
  EXPECT_FALSE(EstimateResponse(u.t, u.v, y, {.from_hz = 5, .to_hz = 600}).ok());  // beyond Nyquist
  EXPECT_FALSE(EstimateResponse(u.t, u.v, y, {.from_hz = 50, .to_hz = 5}).ok());
  const std::vector<double> zero(u.v.size(), 0.0);
  EXPECT_FALSE(EstimateResponse(u.t, zero, y, {.from_hz = 5, .to_hz = 115}).ok());
  for (const Bad& bad : Gallery(u)) {
    const Response as_input = EstimateResponse(bad.signal.t, bad.signal.v, y, {.from_hz = 5, .to_hz = 115});
    const Response as_output = EstimateResponse(u.t, u.v, bad.signal.v, {.from_hz = 5, .to_hz = 115});
    EXPECT_FALSE(as_input.ok()) << bad.what;
    EXPECT_TRUE(IsOneLine(as_input.reason));
    if (bad.what.find("time") == std::string::npos || bad.signal.v.size() != u.v.size()) {
      EXPECT_FALSE(as_output.ok()) << bad.what;
    }
  }
}

// Amplitudes of a two-mass chain: resonances at 20 and 50 Hz with a zero at 30 Hz between.
struct Curve {
  std::vector<double> f, a;
};
Curve TwoModes(double scale = 1.0, double zeta = 0.01) {
  Curve c;
  for (double f = 5; f <= 100; f += 0.02) {
    c.f.push_back(f);
    c.a.push_back(scale * Gain({20, zeta}, f) * Gain({50, zeta}, f) / Gain({30, zeta}, f));
  }
  return c;
}

TEST(Peaks, FindsResonancesAndAntiResonancesOfAClosedForm) {
  const Curve c = TwoModes();
  const PeakList list = FindPeaks(c.f, c.a, 3.0);
  ASSERT_EQ(list.peaks.size(), 3U);
  const double where[] = {20, 30, 50};
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_EQ(list.peaks[i].kind, i == 1 ? PeakKind::kAntiResonance : PeakKind::kResonance);
    EXPECT_NEAR(list.peaks[i].frequency_hz, where[i], 0.02);  // zeta^2 and the slope of the other factors: below 1e-3
    ASSERT_TRUE(list.peaks[i].damping_ratio.has_value());
    EXPECT_NEAR(*list.peaks[i].damping_ratio, 0.01,
                2e-4);  // -3 dB points between bins of 0.02 Hz; second order in zeta
  }
  EXPECT_NEAR(list.peaks[0].height, Gain({20, 0.01}, 20) * Gain({50, 0.01}, 20) / Gain({30, 0.01}, 20), 0.01 * 50);
}

TEST(Peaks, RippleBelowTheProminenceAndEndsOfTheBandAreNone) {
  Curve c = TwoModes();
  for (std::size_t i = 0; i < c.a.size(); ++i)
    c.a[i] *= 1.0 + 0.05 * std::sin(40.0 * c.f[i]);  // 0.9 dB from top to bottom
  EXPECT_EQ(FindPeaks(c.f, c.a, 3.0).peaks.size(), 3U);
  std::vector<double> f, falling;
  for (int i = 1; i < 50; ++i) {
    f.push_back(i);
    falling.push_back(100.0 / i);
  }
  const PeakList none = FindPeaks(f, falling, 1.0);
  EXPECT_TRUE(none.ok());
  EXPECT_TRUE(none.peaks.empty());
}

TEST(Peaks, PlateauNextToAPeakGivesDampingFromOneSide) {
  // The right side never falls by 3 dB before the curve rises again to a second resonance close by.
  Curve c;
  for (double f = 5; f <= 40; f += 0.01) {
    c.f.push_back(f);
    c.a.push_back(Gain({20, 0.03}, f) + 0.4);
  }
  const PeakList list = FindPeaks(c.f, c.a, 3.0);
  ASSERT_EQ(list.peaks.size(), 1U);
  EXPECT_TRUE(list.peaks[0].damping_ratio.has_value());
}

std::vector<ExpectedPeak> Expected() {
  return {{PeakKind::kResonance, 20.0, {}, {}},
          {PeakKind::kAntiResonance, 30.0, {}, {}},
          {PeakKind::kResonance, 50.0, {}, {}}};
}

TEST(Peaks, ComparisonNamesMissingExtraMovedHeightAndDamping) {
  const Curve c = TwoModes();
  const PeakList list = FindPeaks(c.f, c.a, 3.0);
  const PeakLimits limits{.frequency = 0.005, .height = 0.05, .damping = 0.1};
  EXPECT_TRUE(ComparePeaks(list, Expected(), limits).ok());
  EXPECT_LT(ComparePeaks(list, Expected(), limits).worst, 1.0);

  auto expected = Expected();
  expected[2].frequency_hz = 51.0;  // 2 % off
  PeakComparison r = ComparePeaks(list, expected, limits);
  EXPECT_FALSE(r.ok());
  EXPECT_NEAR(r.worst, (1.0 / 51.0) / 0.005, 0.02);
  EXPECT_NE(r.reason.find("resonance at 51 Hz: moved from 51 to"), std::string::npos) << r.reason;

  expected = Expected();
  expected.push_back({PeakKind::kResonance, 80.0, {}, {}});
  r = ComparePeaks(list, expected, limits);
  EXPECT_NE(r.reason.find("resonance at 80 Hz: missing"), std::string::npos) << r.reason;

  expected = Expected();
  expected.pop_back();
  r = ComparePeaks(list, expected, limits);
  EXPECT_FALSE(r.ok());
  ASSERT_EQ(r.extra.size(), 1U);
  PeakLimits lenient = limits;
  lenient.extra_allowed = true;
  EXPECT_TRUE(ComparePeaks(list, expected, lenient).ok());

  expected = Expected();
  expected[0].height = 1.2 * list.peaks[0].height;
  EXPECT_NE(ComparePeaks(list, expected, limits).reason.find("height"), std::string::npos);
  expected = Expected();
  expected[0].damping_ratio = 0.02;
  EXPECT_NE(ComparePeaks(list, expected, limits).reason.find("damping ratio"), std::string::npos);
  expected = Expected();
  expected[1].kind = PeakKind::kResonance;  // an anti-resonance is no resonance
  EXPECT_FALSE(ComparePeaks(list, expected, limits).ok());
}

TEST(Peaks, NothingUnsoundPasses) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const Curve c = TwoModes();
  const PeakLimits limits{.frequency = 0.5, .height = 0.5, .damping = 0.5};
  for (const Bad& bad : Gallery({c.f, c.a})) {
    const PeakList list = FindPeaks(bad.signal.t, bad.signal.v, 3.0);
    EXPECT_FALSE(list.ok()) << bad.what;
    EXPECT_TRUE(IsOneLine(list.reason));
    EXPECT_FALSE(ComparePeaks(list, Expected(), limits).ok());
  }
  std::vector<double> zero = c.a;
  zero[5] = 0.0;
  EXPECT_FALSE(FindPeaks(c.f, zero, 3.0).ok());
  EXPECT_FALSE(FindPeaks(c.f, c.a, nan).ok());
  PeakList list = FindPeaks(c.f, c.a, 3.0);
  EXPECT_FALSE(ComparePeaks(list, {}, limits).ok());
  EXPECT_FALSE(ComparePeaks(list, Expected(), {}).ok());
  auto expected = Expected();
  expected[0].height = nan;
  EXPECT_FALSE(ComparePeaks(list, expected, limits).ok());
  expected = Expected();
  expected[0].height = 1.0;
  list.peaks[0].height = nan;
  EXPECT_FALSE(ComparePeaks(list, expected, limits).ok());
}

}  // namespace
}  // namespace dynoproof::score
