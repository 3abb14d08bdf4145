// Resonances and anti-resonances of an amplitude response, and their comparison with a list of expected ones.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "score/series.h"

namespace dynoproof::score {

enum class PeakKind { kResonance, kAntiResonance };

struct Peak {
  PeakKind kind = PeakKind::kResonance;
  double frequency_hz = 0.0;            // of the practical resonance: the local extremum of the amplitude
  double height = 0.0;                  // amplitude there
  std::optional<double> damping_ratio;  // from the -3 dB points; empty where the curve turns before it gets there
};

struct PeakList : Outcome {
  std::vector<Peak> peaks;  // by rising frequency
};

/// All extrema that stand out by at least `prominence_db` on both sides. Position and height by a parabola through the
/// logarithm; damping as (f2^2 - f1^2) / (4 f0^2) from the points 3 dB below a resonance (above an anti-resonance),
/// right to first order in the damping. With one such point only, the other is taken as its mirror image. An extremum
/// at either end of the band is none. Needs 8 finite positive amplitudes over strictly rising frequencies.
PeakList FindPeaks(std::span<const double> frequency_hz, std::span<const double> amplitude, double prominence_db);

struct ExpectedPeak {
  PeakKind kind = PeakKind::kResonance;
  double frequency_hz = 0.0;
  std::optional<double> height = {};  // judged where given
  std::optional<double> damping_ratio = {};
};

struct PeakLimits {
  double frequency = 0.0;      // largest relative error that passes
  double height = 0.0;         // the same for heights; needed if an expected peak has one
  double damping = 0.0;        // the same for damping ratios
  double search = 0.15;        // how far (relative) a peak may have moved and still be the same one
  bool extra_allowed = false;  // peaks that nobody expected
};

struct PeakMatch {
  ExpectedPeak expected;
  std::optional<Peak> found;  // empty: missing
  std::string fault;          // empty: as expected
};

struct PeakComparison : Outcome {
  std::vector<PeakMatch> matches;  // one for each expected peak
  std::vector<Peak> extra;
  double worst = 0.0;  // largest error over its limit among the matches; infinite when one is missing or extra
};

/// Pairs the closest peaks of one kind first and lists what is missing, extra, moved, or of another height or damping.
/// An empty list of expectations compares nothing and fails.
PeakComparison ComparePeaks(const PeakList& found, std::span<const ExpectedPeak> expected, const PeakLimits& limits);

}  // namespace dynoproof::score
