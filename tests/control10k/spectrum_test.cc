// The estimator: the bank against a plain DFT, the two approximations of the thesis against the exact lobe, and
// accuracy over random tones.
#include "control10k/spectrum.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>
#include <vector>

#include "base/random.h"

namespace control10k {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr int kBlock = 128, kBins = 24;
constexpr double kPeriod = 1e-4, kBin_Hz = 78.125;

GoertzelTables Tables(int block = kBlock, int bins = kBins) {
  GoertzelTables tables;
  EXPECT_TRUE(MakeTables(block, bins, tables));
  return tables;
}

std::vector<double> Spectrum(const std::vector<double>& x, int bins = kBins) {
  const GoertzelTables tables = Tables(static_cast<int>(x.size()), bins);
  Goertzel bank;
  std::vector<double> magnitudes(bins);
  bool complete = false;
  for (const double value : x) complete = bank.Step(tables, value);
  EXPECT_TRUE(complete);
  bank.Magnitudes(tables, magnitudes.data());
  return magnitudes;
}

/// abs(X~) of a complex exponential of amplitude 1 at a distance of delta bins, by its definition.
double ExactLobe(double delta, int block) {
  std::complex<double> sum = 0.0;
  for (int n = 0; n < block; ++n) {
    const double x = 2 * kPi * n / block;
    sum += (0.42 - 0.5 * std::cos(x) + 0.08 * std::cos(2 * x)) * std::polar(1.0, x * delta);
  }
  return std::abs(sum);
}

TEST(Goertzel, IsTheWindowedDft) {
  std::vector<double> x(kBlock);
  for (int n = 0; n < kBlock; ++n) x[n] = dynoproof::RandomNormal(3, 0, n);
  const std::vector<double> magnitudes = Spectrum(x);
  for (int k = 1; k <= kBins; ++k) {
    std::complex<double> sum = 0.0;
    for (int n = 0; n < kBlock; ++n) {
      const double w = 0.42 - 0.5 * std::cos(2 * kPi * n / kBlock) + 0.08 * std::cos(4 * kPi * n / kBlock);
      sum += x[n] * w * std::polar(1.0, -2 * kPi * k * n / kBlock);
    }
    EXPECT_NEAR(magnitudes[k - 1], std::abs(sum), 1e-11) << k;  // round-off of 128 terms of size 1
  }
}

TEST(Goertzel, BeginsAnewAfterEachBlock) {
  const GoertzelTables tables = Tables();
  Goertzel bank;
  std::vector<double> first(kBins), second(kBins);
  for (int block = 0; block < 2; ++block) {
    for (int n = 0; n < kBlock; ++n) {
      EXPECT_EQ(bank.Step(tables, std::sin(2 * kPi * 8.3 * n / kBlock)), n == kBlock - 1);
    }
    bank.Magnitudes(tables, (block == 0 ? first : second).data());
  }
  EXPECT_EQ(first, second);
}

TEST(Goertzel, RefusesWhatDoesNotFit) {
  GoertzelTables tables;
  EXPECT_FALSE(MakeTables(2, 3, tables));
  EXPECT_FALSE(MakeTables(kMaxBlock + 1, 24, tables));
  EXPECT_FALSE(MakeTables(128, kMaxBins + 1, tables));
  EXPECT_FALSE(MakeTables(32, 16, tables));  // bin 16 is the Nyquist frequency
}

TEST(Interpolation, OffsetOfAComplexToneIsWithinTheThesisClaim) {
  double worst = 0.0;
  for (double d = -0.5; d <= 0.5; d += 0.001) {
    const double offset = BlackmanOffset(ExactLobe(d + 1, kBlock), ExactLobe(d, kBlock), ExactLobe(d - 1, kBlock));
    worst = std::max(worst, std::abs(offset - d));
  }
  EXPECT_NEAR(worst, 0.0082, 0.0001);  // bins: 0.64 Hz
}

TEST(Interpolation, LobeIsNearlyGaussian) {
  double worst = 0.0;
  for (double d = -0.5; d <= 0.5; d += 0.001) {
    worst = std::max(worst, std::abs(BlackmanLobe(d) / (ExactLobe(d, 100) / ExactLobe(0.0, 100)) - 1.0));
  }
  EXPECT_LT(worst, 0.01);
  EXPECT_GT(worst, 0.001);
}

TEST(Interpolation, RectangularOffsetIsExactForOneComplexTone) {
  const auto lobe = [](double d) {
    return d == 0.0 ? kBlock : std::abs(std::sin(kPi * d) / std::sin(kPi * d / kBlock));
  };
  for (double d = -0.49; d <= 0.5; d += 0.0101) {
    EXPECT_NEAR(RectangularOffset(lobe(d + 1), lobe(d), lobe(d - 1)), d, 2e-4) << d;
  }
  EXPECT_EQ(RectangularOffset(0.3, 1.0, 0.3), 0.0);  // printed 0/0
  EXPECT_EQ(RectangularOffset(0.0, 1.0, 0.0), 0.0);
}

TEST(Interpolation, TheWindowKeepsTheImageOfARealToneAway) {
  double rectangular = 0.0, blackman = 0.0;
  for (double f = 200.0; f < 1750.0; f += 3.7) {
    std::vector<double> x(kBlock);
    for (int n = 0; n < kBlock; ++n) x[n] = std::sin(2 * kPi * f * kPeriod * n + 0.3);
    const Peak peak = FindPeak(Spectrum(x).data(), kBins, kBlock, kPeriod);
    blackman = std::max(blackman, std::abs(peak.frequency_Hz - f));
    std::vector<double> plain(kBins);
    for (int k = 1; k <= kBins; ++k) {
      std::complex<double> sum = 0.0;
      for (int n = 0; n < kBlock; ++n) sum += x[n] * std::polar(1.0, -2 * kPi * k * n / kBlock);
      plain[k - 1] = std::abs(sum);
    }
    const auto top = std::max_element(plain.begin() + 1, plain.end() - 1) - plain.begin();
    const double offset = RectangularOffset(plain[top - 1], plain[top], plain[top + 1]);
    rectangular = std::max(rectangular, std::abs((static_cast<double>(top) + 1 + offset) * kBin_Hz - f));
  }
  EXPECT_LT(blackman, 0.0083 * kBin_Hz * 1.05);
  EXPECT_GT(rectangular, 3.0 * blackman);
}

TEST(Peak, TheFirstOfEqualLinesAndTheEdges) {
  std::vector<double> m(kBins, 1.0);
  EXPECT_EQ(FindPeak(m.data(), kBins, kBlock, kPeriod).bin, 1);
  EXPECT_FALSE(FindPeak(m.data(), kBins, kBlock, kPeriod).interior);
  m[kBins - 1] = 2.0;
  EXPECT_FALSE(FindPeak(m.data(), kBins, kBlock, kPeriod).interior);
  m.assign(kBins, 0.0);
  EXPECT_FALSE(FindPeak(m.data(), kBins, kBlock, kPeriod).interior);
  EXPECT_EQ(FindPeak(m.data(), kBins, kBlock, kPeriod).amplitude, 0.0);
}

TEST(Condition3, WhatFivePerCentRejectsOfCleanTones) {
  // The neighbour that is further away falls out beyond 0.445 bins, the nearer one never does.
  double first_rejected = 1.0, near_worst = 0.0, far_worst = 0.0;
  for (double d = 0.0; d <= 0.5; d += 0.0005) {
    const double m[3] = {ExactLobe(d + 1, kBlock), ExactLobe(d, kBlock), ExactLobe(d - 1, kBlock)};
    Peak peak;
    peak.bin = 2;
    peak.offset = BlackmanOffset(m[0], m[1], m[2]);
    near_worst = std::max(near_worst, LobeMisfit(m, peak, 1));
    far_worst = std::max(far_worst, LobeMisfit(m, peak, -1));
    if (LobeMisfit(m, peak, -1) > 0.05) first_rejected = std::min(first_rejected, d);
  }
  EXPECT_NEAR(first_rejected, 0.445, 0.005);
  EXPECT_LT(near_worst, 0.03);
  EXPECT_NEAR(far_worst, 0.057, 0.002);
}

TEST(Condition3, SeesASecondTone) {
  std::vector<double> x(kBlock);
  for (int n = 0; n < kBlock; ++n) {
    x[n] = std::sin(2 * kPi * 832 * kPeriod * n) + 0.5 * std::sin(2 * kPi * 940 * kPeriod * n + 1.0);
  }
  const std::vector<double> m = Spectrum(x);
  const Peak peak = FindPeak(m.data(), kBins, kBlock, kPeriod);
  EXPECT_GT(std::max(LobeMisfit(m.data(), peak, 1), LobeMisfit(m.data(), peak, -1)), 0.12);
}

TEST(Estimator, ErrorsOverRandomTones) {
  // Frequencies of the allowed band, amplitudes 20 ... 1000, any phase, noise of 1 % of the amplitude: quantiles of the
  // errors over 2000 tones. The ledger has the same figures.
  std::vector<double> frequency, amplitude;
  for (int i = 0; i < 2000; ++i) {
    const auto uniform = [i](int stream) { return dynoproof::RandomUniform(7, stream, i); };
    const double f = 160.0 + 1630.0 * uniform(0), a = 20.0 * std::pow(50.0, uniform(1)), phase = 2 * kPi * uniform(2);
    std::vector<double> x(kBlock);
    for (int n = 0; n < kBlock; ++n) {
      x[n] = a * (std::sin(2 * kPi * f * kPeriod * n + phase) + 0.01 * dynoproof::RandomNormal(8, i, n));
    }
    const Peak peak = FindPeak(Spectrum(x).data(), kBins, kBlock, kPeriod);
    frequency.push_back(std::abs(peak.frequency_Hz - f));
    amplitude.push_back(std::abs(peak.amplitude / a - 1.0));
  }
  std::sort(frequency.begin(), frequency.end());
  std::sort(amplitude.begin(), amplitude.end());
  EXPECT_LT(frequency[1000], 0.6);
  EXPECT_LT(frequency[1980], 1.2);
  EXPECT_LT(amplitude[1980], 0.015);
}

}  // namespace
}  // namespace control10k
