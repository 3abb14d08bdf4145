// The Fourier transform and amplitude spectra: definition, scaling, Parseval, tones between bins.
#include "score/spectrum.h"

#include <gtest/gtest.h>

#include <complex>

#include "score/fft.h"
#include "tests/score/signals.h"

namespace dynoproof::score {
namespace {

constexpr Window kWindows[] = {Window::kRectangular, Window::kHann, Window::kBlackman};

TEST(Fft, IsItsDefinitionForAnyLength) {
  std::mt19937_64 random(3);
  std::normal_distribution<double> normal;
  for (std::size_t n : {1, 2, 3, 7, 8, 11, 13, 60, 97, 101, 210, 257}) {
    std::vector<std::complex<double>> x(n);
    for (auto& v : x) v = {normal(random), normal(random)};
    const auto fast = Fft(x);
    for (std::size_t k = 0; k < n; ++k) {
      std::complex<double> sum = 0.0;
      for (std::size_t i = 0; i < n; ++i) sum += x[i] * std::polar(1.0, -2 * kPi * Num(i * k % n) / Num(n));
      EXPECT_NEAR(std::abs(fast[k] - sum), 0.0, 1e-12 * Num(n)) << n;  // round-off of n terms of order one
    }
    const auto back = InverseFft(fast);
    for (std::size_t i = 0; i < n; ++i) EXPECT_NEAR(std::abs(back[i] - x[i]), 0.0, 1e-12);
  }
  EXPECT_TRUE(Fft(std::vector<double>()).empty());
}

TEST(Fft, CrossCorrelationByHand) {
  const std::vector<double> a = {1, 2, 3}, b = {0, 1, 0.5};
  const std::vector<double> c = CrossCorrelation(a, b, 2);  // sum a[n] b[n + l], l = -2 .. 2
  const double expected[] = {0.0, 3.0, 3.5, 2.0, 0.5};
  for (std::size_t i = 0; i < 5; ++i) EXPECT_NEAR(c[i], expected[i], 1e-14);
}

TEST(Spectrum, PeriodicWindowsByHand) {
  const std::vector<double> hann = WindowWeights(Window::kHann, 4), blackman = WindowWeights(Window::kBlackman, 4);
  const double h[] = {0.0, 0.5, 1.0, 0.5}, b[] = {0.0, 0.34, 1.0, 0.34};
  for (std::size_t i = 0; i < 4; ++i) {
    EXPECT_NEAR(hann[i], h[i], 1e-15);
    EXPECT_NEAR(blackman[i], b[i], 1e-15);
  }
}

TEST(Spectrum, ToneOnABinReadsItsAmplitudeWithEveryWindow) {
  for (std::size_t n : {200, 211}) {  // 211 is prime
    const double f = 20.0 / (Num(n) * 0.01);
    const Signal s = Sampled(n, 0.01, [&](double t) { return 1.5 + 3.0 * std::cos(2 * kPi * f * t + 0.7); });
    for (Window w : kWindows) {
      const Spectrum spectrum = AmplitudeSpectrum(s.View(), w);
      ASSERT_TRUE(spectrum.ok()) << spectrum.reason;
      EXPECT_NEAR(spectrum.amplitude[20], 3.0, 1e-12);
      EXPECT_NEAR(spectrum.frequency_hz[20], f, 1e-12);
      EXPECT_NEAR(spectrum.amplitude[0], 1.5, 1e-12);
      EXPECT_NEAR(AmplitudeSpectrum(s.View(), w, true).amplitude[0], 0.0, 1e-12);
      EXPECT_EQ(spectrum.amplitude.size(), n / 2 + 1);
    }
  }
}

TEST(Spectrum, NyquistBinHasNoTwin) {
  const Signal s = Sampled(64, 1.0, [](double t) { return std::fmod(t, 2.0) < 0.5 ? 2.0 : -2.0; });
  EXPECT_NEAR(AmplitudeSpectrum(s.View(), Window::kRectangular).amplitude[32], 2.0, 1e-13);
}

TEST(Spectrum, BandsObeyParseval) {
  std::mt19937_64 random(9);
  std::normal_distribution<double> normal;
  const Signal noise = Sampled(1009, 1e-3, [&](double) { return normal(random); });
  const Spectrum plain = AmplitudeSpectrum(noise.View(), Window::kRectangular);
  const double all = RmsInBand(plain, 0, 500).rms;
  EXPECT_NEAR(all, RootMeanSquare(noise.v), 1e-12);
  EXPECT_NEAR(std::hypot(RmsInBand(plain, 0, 200.2).rms, RmsInBand(plain, 200.3, 500).rms), all, 1e-12);
  for (Window w : kWindows) {  // a tone on a bin carries a / sqrt(2) within its main lobe
    const Signal tone = Sampled(1000, 1e-3, [](double t) { return 3.0 * std::sin(2 * kPi * 100 * t); });
    EXPECT_NEAR(RmsInBand(AmplitudeSpectrum(tone.View(), w), 97, 103).rms, 3.0 / std::sqrt(2.0), 1e-12);
  }
}

TEST(Spectrum, ToneBetweenBinsIsFound) {
  for (Window w : kWindows) {
    // The mirror image leaks with 1/k (rectangular), 1/k^3 (Hann, Blackman) at k = 200 bins away.
    const double leak = w == Window::kRectangular ? 2e-2 : 1e-6;
    for (double offset : {-0.5, -0.31, 0.0, 0.2, 0.49}) {
      const double f = 100.0 + offset;
      const Signal s = Sampled(1000, 1e-3, [&](double t) { return 3.0 * std::sin(2 * kPi * f * t + 1.1); });
      const Tone tone = DominantTone(AmplitudeSpectrum(s.View(), w), 10, 400);
      ASSERT_TRUE(tone.ok()) << tone.reason;
      EXPECT_NEAR(tone.frequency_hz, f, leak);
      EXPECT_NEAR(tone.amplitude, 3.0, 3.0 * leak);
    }
  }
}

TEST(Spectrum, StrongestToneOfTheBandCounts) {
  const Signal s =
      Sampled(1000, 1e-3, [](double t) { return 3.0 * std::sin(2 * kPi * 50 * t) + std::sin(2 * kPi * 200 * t); });
  const Spectrum spectrum = AmplitudeSpectrum(s.View(), Window::kHann);
  EXPECT_NEAR(DominantTone(spectrum, 10, 400).frequency_hz, 50.0, 1e-6);
  EXPECT_NEAR(DominantTone(spectrum, 100, 400).frequency_hz, 200.0, 1e-6);
  EXPECT_FALSE(DominantTone(spectrum, 600, 700).ok());
  EXPECT_FALSE(DominantTone(spectrum, 51, 60).ok());  // only the flank of a tone outside
}

TEST(Spectrum, NothingUnsoundPasses) {
  const Signal good = Sampled(100, 0.01, [](double t) { return std::sin(20 * t); });
  for (const Bad& bad : Gallery(good)) {
    const Spectrum spectrum = AmplitudeSpectrum(bad.signal.View(), Window::kHann);
    EXPECT_FALSE(spectrum.ok()) << bad.what;
    EXPECT_TRUE(IsOneLine(spectrum.reason)) << bad.what;
    EXPECT_FALSE(RmsInBand(spectrum, 0, 1e3).ok());
    EXPECT_FALSE(DominantTone(spectrum, 0, 1e3).ok());
  }
  Signal uneven = good;
  uneven.t[50] += 0.001;
  EXPECT_FALSE(AmplitudeSpectrum(uneven.View(), Window::kHann).ok());
  const Spectrum spectrum = AmplitudeSpectrum(good.View(), Window::kHann);
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(RmsInBand(spectrum, nan, 10).ok());
  EXPECT_FALSE(RmsInBand(spectrum, 10, 5).ok());
  EXPECT_FALSE(DominantTone(spectrum, nan, nan).ok());
  EXPECT_FALSE(RmsInBand({}, 0, 10).ok());
}

}  // namespace
}  // namespace dynoproof::score
