#include "experiment/check_time_course.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "score/spectrum.h"

namespace dynoproof {
namespace {

void CheckPair(Faults& faults, const char* key, const std::vector<double>& pair, bool optional) {
  if (optional && pair.empty()) return;
  if (pair.size() != 2 || pair[0] >= pair[1]) faults.At(key, "write [from, to] with from < to");
}

/// The part of a signal between two times; all of it when `during` is empty.
score::Series Stretch(const score::Series& all, const std::vector<double>& during) {
  if (during.empty()) return all;
  const double slack = 0.5e-9;  // half a tick of the engine's clock
  const auto first = std::lower_bound(all.time_s.begin(), all.time_s.end(), during[0] - slack) - all.time_s.begin();
  const auto last = std::upper_bound(all.time_s.begin(), all.time_s.end(), during[1] + slack) - all.time_s.begin();
  return {all.time_s.subspan(first, last - first), all.values.subspan(first, last - first), all.interpolation};
}

score::Check Failed(std::string name, std::string kind, std::string unit, const std::string& origin, std::string why) {
  score::Check check;
  check.name = std::move(name);
  check.kind = std::move(kind);
  check.value = check.limit = std::numeric_limits<double>::quiet_NaN();
  check.unit = std::move(unit);
  check.origin = origin;
  check.explanation = std::move(why);
  return check;
}

}  // namespace

void PeakCheck::Params::Check(Faults& faults) const {
  CheckPair(faults, "band_Hz", band_Hz, false);
  CheckPair(faults, "between_Hz", between_Hz, false);
  CheckPair(faults, "during_s", during_s, true);
}

std::vector<score::Check> PeakCheck::Run(CheckContext& context) const {
  const std::string name = fmt::format("{} {}", p_.figure, p_.signal);
  const score::Series signal = Stretch(SeriesOf(context.samples(), context.rig(), p_.signal), p_.during_s);
  const score::Spectrum spectrum = score::AmplitudeSpectrum(signal, score::Window::kHann, true);
  if (!spectrum.ok()) return {Failed(name, kName, "Hz", p_.origin, spectrum.reason)};
  const score::Tone tone = score::DominantTone(spectrum, p_.band_Hz[0], p_.band_Hz[1]);
  if (!tone.ok()) return {Failed(name, kName, "Hz", p_.origin, tone.reason)};
  std::string unit = context.rig().outputs[FindOutput(context.rig(), p_.signal)].unit, suffix = unit;
  std::erase(suffix, ' ');
  std::replace(suffix.begin(), suffix.end(), '/', '_');
  context.figures[p_.figure + "_hz"] = {tone.frequency_hz, "Hz"};
  context.figures[p_.figure + "_" + suffix] = {tone.amplitude, unit};
  const double middle = 0.5 * (p_.between_Hz[0] + p_.between_Hz[1]);
  return {score::AtMost(name, kName, std::abs(tone.frequency_hz - middle), p_.between_Hz[1] - middle, "Hz", p_.origin,
                        fmt::format("{:.3f} Hz with {:.4g} {}; allowed {:g} to {:g} Hz", tone.frequency_hz,
                                    tone.amplitude, unit, p_.between_Hz[0], p_.between_Hz[1]))};
}

void FollowsCheck::Params::Check(Faults& faults) const { CheckPair(faults, "during_s", during_s, true); }

std::vector<score::Check> FollowsCheck::Run(CheckContext& context) const {
  const std::string name = fmt::format("{} follows {}", p_.signal, p_.reference);
  const std::string unit = context.rig().outputs[FindOutput(context.rig(), p_.signal)].unit;
  const score::Series signal = Stretch(SeriesOf(context.samples(), context.rig(), p_.signal), p_.during_s);
  const score::Series wanted = Stretch(SeriesOf(context.samples(), context.rig(), p_.reference), p_.during_s);
  double largest = signal.values.empty() ? std::numeric_limits<double>::quiet_NaN() : 0.0, when = 0.0;
  for (std::size_t i = 0; i < signal.values.size(); ++i) {
    const double distance = std::abs(signal.values[i] - wanted.values[i]);
    if (distance <= largest) continue;
    largest = distance;
    when = signal.time_s[i];
  }
  score::Check check =
      score::AtMost(name, kName, largest, p_.largest, unit, p_.origin, fmt::format("farthest at {:.4f} s", when));
  check.evidence = score::BandEvidence({p_.signal, unit, p_.reference, "run"}, score::Evidence::Rule::kEverySample,
                                       wanted, signal, p_.largest);
  return {check};
}

}  // namespace dynoproof
