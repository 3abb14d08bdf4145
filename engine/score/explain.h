// Why a test signal differs from its reference: one line for people and the same for machines.
//
// Each candidate is fitted to the difference; what counts is the part of the difference's mean square that it removes.
// The simplest candidate wins unless a more complex one halves what is left. A candidate is named only if it removes 90
// %, and, below 99.5 %, only if what is left has no visible relation to the reference (its derivatives, powers or
// products with time): a lag is no delay and a saturation no gain, even where they remove 95 %. Otherwise: "no simple
// cause".
#pragma once

#include <string>
#include <string_view>

#include "score/series.h"

namespace dynoproof::score {

enum class Cause {
  kNone,       // no candidate explains the difference
  kIdentical,  // there is no difference beyond round-off
  kShift,      // test(t) = reference(t - shift)
  kGain,       // gain * reference
  kOffset,     // reference + offset
  kGainAndOffset,
  kShiftAndGain,
  kShiftAndOffset,
  kShiftGainAndOffset,
  kSignFlip,  // -reference
  kMirrored,  // offset - reference
  kSignLost,  // the magnitude of the reference, or its negative
  kDrift,     // reference + slope * t
  kDriftAndOffset,
  kStartValue,       // the difference decays: one exponential or up to three ringing modes
  kResonanceMoved,   // one resonance at another frequency
  kDampingChanged,   // one resonance with another damping
  kEventsShifted,    // the same events at other times
  kEventsReordered,  // the same events in another order
  kEventsMissing,    // other events
  kNoise,            // the difference is white, steady, bell-shaped and unrelated to the reference
  kDivergence,       // equal up to a moment, different from then on
};

/// Name for machines, e.g. "gain_and_offset".
std::string_view ToString(Cause cause);

struct Event {
  double time_s = 0.0;
  std::string name;
};

struct ExplainOptions {
  std::string unit = {};                         // of the signal, for the text
  double least_explained = 0.9;                  // of the difference's mean square; 0.9 to 1
  std::span<const Event> reference_events = {};  // by time; both lists or none
  std::span<const Event> test_events = {};
};

struct Quantity {
  std::string name;  // "shift", "gain", "offset", ...
  double value = 0.0;
  std::string unit;
};

/// The verdict says whether the question could be asked at all; a pass with kNone is an honest "no simple cause".
struct Explanation : Outcome {
  Cause cause = Cause::kNone;
  double magnitude = 0.0;  // of the first quantity
  std::string unit;
  double explained = 0.0;            // fraction of the difference's mean square
  std::vector<Quantity> quantities;  // all that belong to the cause
  std::vector<Cause> alternatives;   // as simple, and as good within a factor of 1.5 in what they leave
  std::string text;                  // one line
};

/// Explains `test` by `reference`, which need 64 samples; the test must cover the reference. A reference that is not
/// uniform is resampled with its median step. Cost: O(n log n), some 5 ms per 1000 samples, more where resonances are
/// fitted.
Explanation Explain(const Series& reference, const Series& test, const ExplainOptions& options = {});

}  // namespace dynoproof::score
