// The frequency response between two records of a chirp experiment (thesis 2.1.3).
#pragma once

#include <complex>
#include <vector>

#include "score/series.h"

namespace dynoproof::score {

/// Instantaneous frequency [Hz] of a linear chirp, f0 + rate (t - t[0]), rate in Hz/s.
std::vector<double> ChirpFrequency(std::span<const double> time_s, double f0_hz, double rate_hz_per_s);

/// Where in the record (s) a rising or falling frequency map first reaches `hz`, linearly between samples; NaN if
/// never.
double TimeOfFrequency(std::span<const double> time_s, std::span<const double> frequency_hz, double hz);

struct ResponseOptions {
  double from_hz = 0.0, to_hz = 0.0;  // the band that the chirp sweeps
  double smoothing_hz = 0.0;          // half-width of the Hann kernel over frequency; 0: four over the record length
};

struct Response : Outcome {
  std::vector<double> frequency_hz;
  std::vector<std::complex<double>> gain;  // output over input
  std::vector<double> coherence;           // 0 .. 1: the share of the output that the input explains

  std::vector<double> Magnitude() const;
};

/// H1 = S_yu / S_uu with S smoothed over frequency. Input and output need one uniform time base of at least 64 samples.
/// Both are differenced first, which leaves the ratio as it is and removes constant loads and rest positions. Exact (up
/// to the smoothing) if the plant rests when the record starts and has rung down when it ends. Resonances narrower than
/// the smoothing come out too low. Fails if the input leaves more than a tenth of the band unexcited (power density
/// below 1e-4 of the band's largest); single unexcited bins are left out.
Response EstimateResponse(std::span<const double> time_s, std::span<const double> input, std::span<const double> output,
                          const ResponseOptions& options);

}  // namespace dynoproof::score
