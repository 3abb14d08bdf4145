// The clock of a run: whole nanoseconds, so that 10 kHz ticks never drift. Integrators see seconds.
#pragma once

#include <cmath>
#include <cstdint>
#include <optional>

namespace dynoproof {

/// A point in time or a duration in nanoseconds; int64 reaches 292 years.
using Nanoseconds = std::int64_t;

inline double Seconds(Nanoseconds time) { return static_cast<double>(time) * 1e-9; }

/// The duration in whole nanoseconds, or nothing when `seconds` is not finite, too large for the clock, or further than
/// 1e-3 ns from a whole nanosecond and therefore not a period the clock can keep (1/3 s, say).
inline std::optional<Nanoseconds> ToNanoseconds(double seconds) {
  const double ns = seconds * 1e9;
  if (!(std::abs(ns) < 9e18)) return std::nullopt;
  const double whole = std::round(ns);
  // Decimal notation leaves a rounding error that grows with the magnitude: 2 ulp beside the 1e-3 ns.
  if (std::abs(ns - whole) > 1e-3 + 4.5e-16 * std::abs(ns)) return std::nullopt;
  return static_cast<Nanoseconds>(whole);
}

}  // namespace dynoproof
