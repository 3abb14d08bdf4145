// A tone in a stretch of a signal: its frequency and amplitude by a windowed Fourier transform.
#pragma once

#include <span>

namespace dynoproof {

struct Tone {
  double frequency_Hz = 0.0, amplitude = 0.0;
};

/// Amplitude of the Blackman-windowed Fourier transform at a frequency: that of a tone there, as long as no other lies
/// within three times the inverse length of the stretch.
double AmplitudeAt(std::span<const double> values, double period_s, double f_Hz);

/// The largest component within `half_Hz` of a frequency, found to 0.02 Hz.
Tone StrongestTone(std::span<const double> values, double period_s, double near_Hz, double half_Hz);

}  // namespace dynoproof
