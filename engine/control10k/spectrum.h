// From samples to one tone: a Goertzel bank (5.30) on blocks under a Blackman window (5.23), and the interpolation of
// frequency and amplitude between its bins, (5.25)-(5.29); for comparison (5.22), without a window.
//
// Print and code: the window is the periodic one, sample n = 1..N takes w(n - 1); the coefficient of bin k is
// 2 cos(2 pi k / N) (printed cos(2 pi k N)); only the magnitude is needed, so the sign of the exponent does not matter.
#pragma once

namespace control10k {

inline constexpr int kMaxBlock = 1024, kMaxBins = 32;  // bins are carried in groups of 8

/// Window and coefficients; made once, before the first step.
struct GoertzelTables {
  int block = 0, bins = 0;
  double window[kMaxBlock] = {};
  double coefficient[kMaxBins] = {};  // 2 cos(2 pi k / N), k = 1 .. bins
};

/// False when there is no room: 4 <= block <= kMaxBlock, 3 <= bins <= kMaxBins, bins < block / 2.
bool MakeTables(int block, int bins, GoertzelTables& tables);

struct Goertzel {
  double y1[kMaxBins] = {}, y2[kMaxBins] = {};
  double count = 0.0;  // samples of this block so far

  void Reset() { *this = Goertzel(); }
  /// One sample; true when the block is complete: Magnitudes() is due before the next one.
  bool Step(const GoertzelTables& tables, double x);
  /// abs(X_k), k = 1 .. bins, of the complete block; begins the next one.
  void Magnitudes(const GoertzelTables& tables, double* magnitudes);
};

/// The largest line of a spectrum.
struct Peak {
  int bin = 0;          // k_max, from 1; 0: no spectrum
  double offset = 0.0;  // Delta k, in bins
  double frequency_Hz = 0.0;
  double amplitude = 0.0;  // of a real tone: 2 / (0.42 N) abs(X_x)
  bool interior = false;   // both neighbours exist; else nothing was interpolated
};

/// (5.27): Delta k from the largest line and its neighbours under a Blackman window.
inline double BlackmanOffset(double left, double middle, double right) { return 0.75 * (right - left) / middle; }
/// (5.22): the same for a rectangular window; 0 when both neighbours are equal (printed 0/0).
double RectangularOffset(double left, double middle, double right);
/// (5.28): height of the lobe at a distance of `offset` bins over its maximum.
double BlackmanLobe(double offset);

/// Maximum (the first of equal ones), (5.27) and (5.29).
Peak FindPeak(const double* magnitudes, int bins, int block, double period_s);

/// Condition 3: by how much the right side of (5.35) misses the left one, abs(X_kmax) / abs(X_neighbour), relative to
/// the left; `side` -1: left neighbour, +1: right. The peak must be interior.
double LobeMisfit(const double* magnitudes, const Peak& peak, int side);

}  // namespace control10k
