// One-sided amplitude spectra with windows, band RMS and the dominant tone.
//
// Scaling: a tone a cos(2 pi k n / N + p) on a bin reads a at that bin for every window; a constant c reads |c| at bin
// 0.
#pragma once

#include "score/series.h"

namespace dynoproof::score {

/// Periodic windows (period N, not N - 1), as thesis (5.23) needs for Blackman.
enum class Window { kRectangular, kHann, kBlackman };

struct Spectrum : Outcome {
  std::vector<double> frequency_hz;  // k / (N dt), k = 0 .. N/2
  std::vector<double> amplitude;     // peak values, unit of the signal
  std::vector<double> power;         // share of each bin in the mean square of the signal (Parseval)
  double bin_hz = 0.0;
  std::size_t samples = 0;
  Window window = Window::kHann;
};

/// Weights w(0 .. n-1) of the periodic window.
std::vector<double> WindowWeights(Window window, std::size_t n);

/// Spectrum of a uniformly sampled signal of at least 8 samples. `remove_mean` takes the mean off before windowing.
Spectrum AmplitudeSpectrum(const Series& signal, Window window, bool remove_mean = false);

struct BandRms : Outcome {
  double rms = 0.0;
};
/// RMS of the part of the signal between the two frequencies [Hz], bins included by their centre. With a window the sum
/// over a tone's main lobe is the tone's RMS. Fails for an empty band or one that holds no bin.
BandRms RmsInBand(const Spectrum& spectrum, double from_hz, double to_hz);

struct Tone : Outcome {
  double frequency_hz = 0.0;
  double amplitude = 0.0;
};
/// The largest tone between the two frequencies, between the bins too: the offset from the bin follows from the two
/// neighbours by the window's exact transform, so a lone tone comes out to round-off plus the leakage of its own mirror
/// image. A maximum on the edge of the band or of the spectrum is no tone: failure.
Tone DominantTone(const Spectrum& spectrum, double from_hz, double to_hz);

}  // namespace dynoproof::score
