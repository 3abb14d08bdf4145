#include "score/explain.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "score/candidates.h"
#include "score/residual_tests.h"
#include "score/resonance.h"
#include "score/start_value.h"

namespace dynoproof::score {
namespace {

constexpr double kBeyondDoubt = 0.005;  // unexplained part below which the residual's shape is not asked for
constexpr double kRelated = 0.25;       // R^2 from which a residual counts as following the reference

// Both on the reference's base, or on a uniform one with its median step.
Pair MakePair(const Series& reference, const Series& test) {
  Pair pair;
  pair.start_s = reference.time_s.front();
  const double span = reference.time_s.back() - pair.start_s;
  if (UniformFault(reference.time_s, "").empty()) {
    pair.x.assign(reference.values.begin(), reference.values.end());
    pair.y = SampleAt(test, reference.time_s);
    pair.step_s = span / Num(pair.x.size() - 1);
  } else {
    const double steps = std::min(span / MedianStep(reference.time_s), 4.0 * Num(reference.time_s.size()));
    const auto n = static_cast<std::size_t>(std::max(64.0, std::floor(steps)));
    pair.step_s = span / Num(n);
    std::vector<double> times(n + 1);
    for (std::size_t i = 0; i <= n; ++i) times[i] = pair.start_s + pair.step_s * Num(i);
    pair.x = SampleAt(reference, times);
    pair.y = SampleAt(test, times);
  }
  pair.d.resize(pair.x.size());
  for (std::size_t i = 0; i < pair.x.size(); ++i) {
    pair.d[i] = pair.y[i] - pair.x[i];
    pair.difference_square += pair.d[i] * pair.d[i];
  }
  return pair;
}

std::string EventFault(std::span<const Event> events, std::string_view name) {
  for (std::size_t i = 0; i < events.size(); ++i) {
    if (!std::isfinite(events[i].time_s)) return fmt::format("{}: time of event {} is not finite", name, i);
    if (i > 0 && events[i].time_s < events[i - 1].time_s) return fmt::format("{}: event {} is out of order", name, i);
  }
  return {};
}

bool Accepted(const Pair& pair, const Candidate& c, double least_explained) {
  if (!(c.unexplained <= 1.0 - least_explained)) return false;
  if (c.unexplained <= kBeyondDoubt || !c.structural) return true;
  return RelationToReference(pair, c.residual, c.first) < kRelated;
}

// Drops what is not accepted, then chooses: the simplest, unless a more complex one halves what is left.
const Candidate* Choose(const Pair& pair, Candidates& candidates, double least_explained) {
  std::erase_if(candidates, [&](const Candidate& c) { return !Accepted(pair, c, least_explained); });
  std::stable_sort(candidates.begin(), candidates.end(), [](const Candidate& a, const Candidate& b) {
    return a.complexity != b.complexity ? a.complexity < b.complexity : a.unexplained < b.unexplained;
  });
  // What is left on the level of round-off cannot be halved meaningfully.
  const double floor = 1e-9;
  const Candidate* chosen = nullptr;
  for (const Candidate& c : candidates) {
    if (chosen == nullptr || c.unexplained + floor < 0.5 * (chosen->unexplained + floor)) chosen = &c;
  }
  return chosen;
}

void Report(const Candidate& chosen, const Candidates& all, Explanation& out) {
  out.cause = chosen.cause;
  out.explained = 1.0 - chosen.unexplained;
  out.quantities = chosen.quantities;
  if (!chosen.quantities.empty()) {
    out.magnitude = chosen.quantities.front().value;
    out.unit = chosen.quantities.front().unit;
  }
  out.text = fmt::format("{} (explains {:.4g} % of the difference)", chosen.text, 100.0 * out.explained);
  for (const Candidate& c : all) {
    if (c.cause == chosen.cause || c.complexity > chosen.complexity) continue;
    if (c.unexplained > 1.5 * chosen.unexplained + 1e-6) continue;
    out.alternatives.push_back(c.cause);
    out.text += fmt::format("; as good: {}", c.text);
  }
}

}  // namespace

std::string_view ToString(Cause cause) {
  switch (cause) {
    case Cause::kNone:
      break;
    case Cause::kIdentical:
      return "identical";
    case Cause::kShift:
      return "shift";
    case Cause::kGain:
      return "gain";
    case Cause::kOffset:
      return "offset";
    case Cause::kGainAndOffset:
      return "gain_and_offset";
    case Cause::kShiftAndGain:
      return "shift_and_gain";
    case Cause::kShiftAndOffset:
      return "shift_and_offset";
    case Cause::kShiftGainAndOffset:
      return "shift_gain_and_offset";
    case Cause::kSignFlip:
      return "sign_flip";
    case Cause::kMirrored:
      return "mirrored";
    case Cause::kSignLost:
      return "sign_lost";
    case Cause::kDrift:
      return "drift";
    case Cause::kDriftAndOffset:
      return "drift_and_offset";
    case Cause::kStartValue:
      return "start_value";
    case Cause::kResonanceMoved:
      return "resonance_moved";
    case Cause::kDampingChanged:
      return "damping_changed";
    case Cause::kEventsShifted:
      return "events_shifted";
    case Cause::kEventsReordered:
      return "events_reordered";
    case Cause::kEventsMissing:
      return "events_missing";
    case Cause::kNoise:
      return "noise";
    case Cause::kDivergence:
      return "divergence";
  }
  return "none";
}

Explanation Explain(const Series& reference, const Series& test, const ExplainOptions& options) {
  Explanation out;
  const Aligned aligned = AlignTo(reference, test, 0.0, 64);
  out.reason = aligned.reason;
  if (out.reason.empty()) out.reason = EventFault(options.reference_events, "reference events");
  if (out.reason.empty()) out.reason = EventFault(options.test_events, "test events");
  if (out.reason.empty() && !(options.least_explained >= 0.9 && options.least_explained <= 1.0))
    out.reason = "explain: the least explained part must lie between 0.9 and 1";
  out.text = out.reason;
  if (!out.reason.empty()) return out;

  const Pair pair = MakePair(reference, test);
  out.verdict = Verdict::kPass;
  // Round-off of values that were written and read once: a few ulp of the largest value.
  const double scale = std::max(Largest(pair.x), Largest(pair.y));
  if (Largest(pair.d) <= 8.0 * std::numeric_limits<double>::epsilon() * scale) {
    out.cause = Cause::kIdentical;
    out.explained = 1.0;
    out.text = "no difference beyond round-off";
    return out;
  }

  Candidates candidates;
  AddScalings(pair, options.unit, candidates);
  AddFineShift(pair, test, candidates);
  AddStartValue(pair, options.unit, candidates);
  AddEvents(pair, options, candidates);
  const Candidate* chosen = Choose(pair, candidates, options.least_explained);
  constexpr int kSimple = 5;  // three ringing modes are not simpler than one resonance that moved
  if (chosen == nullptr || (chosen->unexplained > kBeyondDoubt && chosen->complexity > kSimple)) {
    AddResonance(pair, candidates);
    chosen = Choose(pair, candidates, options.least_explained);
  }
  if (chosen == nullptr) {
    AddNoise(pair, options.unit, candidates);
    AddDivergence(pair, candidates);
    chosen = Choose(pair, candidates, options.least_explained);
  }
  if (chosen == nullptr) {
    out.text =
        fmt::format("no single gain, shift, offset, start value or moved resonance explains {:.3g} % of the difference",
                    100.0 * options.least_explained);
    return out;
  }
  Report(*chosen, candidates, out);
  return out;
}

}  // namespace dynoproof::score
