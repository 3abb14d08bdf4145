// A signal as the scores see it: two arrays. What is wrong with one, whether one covers another, and its value at other
// times. Everything here is O(n).
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "score/verdict.h"

namespace dynoproof::score {

enum class Interpolation { kLinear, kHold };

/// A view of a signal: time [s], strictly rising, maybe with varying step, and as many values in the signal's unit.
struct Series {
  std::span<const double> time_s;
  std::span<const double> values;
  Interpolation interpolation = Interpolation::kLinear;
};

/// Why `series` cannot be judged, in one line that starts with `name`; empty if it can. Refused: different lengths,
/// fewer than `min_samples`, NaN or infinity, time that does not rise strictly, magnitudes above 1e150 (whose square
/// overflows).
std::string FaultOf(const Series& series, std::string_view name, std::size_t min_samples = 2);

/// Why the time base is not uniform; empty if no step differs from the mean step by more than a thousandth of it.
/// Spectra need that: a thousandth of a step is a phase error below 0.2 degrees up to the Nyquist frequency.
std::string UniformFault(std::span<const double> time_s, std::string_view name);

/// Whether sample i + 1 follows at the same instant: a time that is a few units in the last place later, which is how
/// rows at one instant, the values before and after an event, are told apart. `time_s` rises strictly.
bool IsJump(std::span<const double> time_s, std::size_t i);

/// Median of the steps of `time_s` [s], jumps left out; needs two samples.
double MedianStep(std::span<const double> time_s);

/// Why `test` does not cover the whole span of `reference`; empty if it does. A thousandth of a reference step is
/// forgiven at both ends (round-off of summed steps); a held signal also counts until its next sample would be due. A
/// gap is a step of the test longer than `max_gap_s` with a reference sample inside; 0 means three times the larger
/// median step.
std::string CoverageFault(const Series& reference, const Series& test, double max_gap_s = 0.0);

/// `series` at rising `times_s` [s] by its own interpolation; before the first and after the last sample their values.
/// A held value counts from a millionth of a step early, so that equal grids with different round-off agree.
std::vector<double> SampleAt(const Series& series, std::span<const double> times_s);

/// `test` on the time base of `reference`, or the reason why they cannot be compared.
struct Aligned : Outcome {
  std::vector<double> test;
};
Aligned AlignTo(const Series& reference, const Series& test, double max_gap_s = 0.0, std::size_t min_samples = 2);

double Mean(std::span<const double> values);
double RootMeanSquare(std::span<const double> values);
/// Divided by n, not n - 1.
double StandardDeviation(std::span<const double> values);
double Median(std::span<const double> values);
/// max |value|.
double Largest(std::span<const double> values);

inline double Num(std::size_t n) { return static_cast<double>(n); }

}  // namespace dynoproof::score
