#include "control10k/spectrum.h"

#include <cmath>

namespace control10k {
namespace {

constexpr double kPi = 3.14159265358979323846;
constexpr int kGroup = 8;

int Groups(int bins) { return (bins + kGroup - 1) / kGroup; }

}  // namespace

bool MakeTables(int block, int bins, GoertzelTables& tables) {
  if (block < 4 || block > kMaxBlock || bins < 3 || bins > kMaxBins || 2 * bins >= block) return false;
  tables = {};
  tables.block = block;
  tables.bins = bins;
  for (int n = 0; n < block; ++n) {
    const double x = 2.0 * kPi * n / block;
    tables.window[n] = 0.42 - 0.5 * std::cos(x) + 0.08 * std::cos(2.0 * x);
  }
  for (int k = 1; k <= bins; ++k) tables.coefficient[k - 1] = 2.0 * std::cos(2.0 * kPi * k / block);
  return true;
}

bool Goertzel::Step(const GoertzelTables& tables, double x) {
  const double windowed = x * tables.window[static_cast<int>(count)];
  const int groups = Groups(tables.bins);
  for (int g = 0; g < groups; ++g) {
    double* __restrict a = y1 + g * kGroup, * __restrict b = y2 + g * kGroup;
    const double* __restrict c = tables.coefficient + g * kGroup;
    for (int i = 0; i < kGroup; ++i) {
      const double next = c[i] * a[i] - b[i] + windowed;
      b[i] = a[i];
      a[i] = next;
    }
  }
  count += 1.0;
  return count >= tables.block;
}

void Goertzel::Magnitudes(const GoertzelTables& tables, double* magnitudes) {
  for (int k = 0; k < tables.bins; ++k) {
    const double a = y1[k], b = y2[k];
    const double square = a * a + b * b - tables.coefficient[k] * a * b;
    magnitudes[k] = square > 0.0 ? std::sqrt(square) : 0.0;
  }
  Reset();
}

double RectangularOffset(double left, double middle, double right) {
  const double d = right - left;
  if (d == 0.0) return 0.0;
  const double sign = d > 0.0 ? 1.0 : -1.0;
  return sign * std::sqrt(d / (2.0 * sign * middle + d));
}

double BlackmanLobe(double offset) {
  const double kSlope = std::log(0.25 / 0.42);
  return std::exp(kSlope * offset * offset);
}

Peak FindPeak(const double* magnitudes, int bins, int block, double period_s) {
  Peak peak;
  int best = 0;
  for (int k = 1; k < bins; ++k) {
    if (magnitudes[k] > magnitudes[best]) best = k;
  }
  peak.bin = best + 1;
  peak.interior = best > 0 && best < bins - 1 && magnitudes[best] > 0.0;
  double top = magnitudes[best];
  if (peak.interior) {
    peak.offset = BlackmanOffset(magnitudes[best - 1], top, magnitudes[best + 1]);
    top /= BlackmanLobe(peak.offset);
  }
  peak.frequency_Hz = (peak.bin + peak.offset) / (block * period_s);
  peak.amplitude = 2.0 / (0.42 * block) * top;
  return peak;
}

double LobeMisfit(const double* magnitudes, const Peak& peak, int side) {
  const double expected = BlackmanLobe(peak.offset) / BlackmanLobe(peak.offset - side);
  return std::abs(expected * magnitudes[peak.bin - 1 + side] / magnitudes[peak.bin - 1] - 1.0);
}

}  // namespace control10k
