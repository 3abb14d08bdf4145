// A run thinned out until it can be kept: every k-th sample of each signal, and of what lies between two of them the
// least, the greatest and the mean value. A lone sample that is off moves the mean of its stretch, ripple its extremes.
#pragma once

#include <array>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "trace/trace.h"

namespace dynoproof {

/// Share of a step by which two stamps may differ and be the same: the round-off of summed steps.
inline constexpr double kStampSlack = 1e-6;

/// The samples at the stamps `kept`; nothing where there is none at one of them (but for round-off).
std::optional<std::vector<double>> SamplesAt(std::span<const double> kept, std::span<const double> time_s,
                                             std::span<const double> values);

/// Least, greatest and mean of all samples in stretches, one value a stretch. A stretch goes from behind one end up to the next, that
/// one included; the first is the first sample alone.
struct Stretches {
  std::vector<double> least, greatest, mean;
  std::vector<double> least_s, greatest_s;  // when they occur
};
/// Nothing where there is no sample at one of the ends, or one behind the last.
std::optional<Stretches> StretchesOf(std::span<const double> ends, std::span<const double> time_s,
                                     std::span<const double> values);

/// The signals of a thinned trace that tell of the stretches of signal `name`: least, greatest, mean.
std::array<std::string, 3> StretchNames(std::string_view name);
/// Whether this signal of a thinned trace is one of those of another.
bool IsOfStretches(const trace::Trace& thin, const trace::Signal& signal);

/// The trace with every k-th sample of each signal (k the same prime for all), and beside each signal its
/// stretches of eight kept samples, up to the last there is, small enough to be kept. A time base of fewer than 4000 samples stays whole, without
/// stretches.
trace::Trace Thin(const trace::Trace& trace, std::size_t most_bytes = 190'000);

}  // namespace dynoproof
