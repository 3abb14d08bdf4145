#include "thesis/check_suppression.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>

#include "base/within.h"
#include "thesis/tone.h"

namespace dynoproof {
namespace {

constexpr double kNear_Hz = 20.0;  // an oscillation is looked for so far from where it is expected

const std::vector<double>& Values(const CheckContext& context, const std::string& output) {
  return context.samples().outputs[static_cast<std::size_t>(FindOutput(context.rig(), output))];
}

score::Check Judge(std::string name, const char* kind, double value, double limit, std::string unit,
                   const std::string& origin, std::string explanation) {
  score::Check check;
  check.name = std::move(name);
  check.kind = kind;
  check.value = value;
  check.limit = limit;
  check.unit = std::move(unit);
  check.origin = origin;
  check.verdict = Within(value, limit) ? score::Verdict::kPass : score::Verdict::kFail;
  if (check.verdict != score::Verdict::kPass) check.explanation = std::move(explanation);
  return check;
}

std::size_t Row(const CheckContext& context, double time_s) {
  const std::vector<double>& time = context.samples().time;
  return static_cast<std::size_t>(std::lower_bound(time.begin(), time.end(), time_s - 1e-9) - time.begin());
}

/// A check of a run that ends before the time that the check looks at.
score::Check EndsBefore(const CheckContext& context, const char* kind, const char* key, double time_s,
                        const std::string& origin) {
  const std::vector<double>& time = context.samples().time;
  return Judge(
      kind, kind, std::numeric_limits<double>::quiet_NaN(), 0.0, "s", origin,
      fmt::format("the run ends at {:.6g} s, before {} = {:.6g} s", time.empty() ? 0.0 : time.back(), key, time_s));
}

double Rms(const std::vector<double>& values, std::size_t begin, std::size_t end) {
  double sum = 0.0;
  for (std::size_t i = begin; i < end; ++i) sum += values[i] * values[i];
  return std::sqrt(sum / static_cast<double>(end - begin));
}

struct Placement {
  double time_s, f_Hz;
};
std::vector<Placement> PlacementsOf(const CheckContext& context, const std::vector<std::string>& notches) {
  std::vector<Placement> placements;
  for (const std::string& notch : notches) {
    const std::vector<double>& f = Values(context, notch);
    for (std::size_t i = 1; i < f.size(); ++i) {
      // The first sample is taken before the control has ticked: 0.
      if (f[i] != f[i - 1] && f[i - 1] > 0.0) placements.push_back({context.samples().time[i], f[i]});
    }
  }
  std::sort(placements.begin(), placements.end(), [](const auto& a, const auto& b) { return a.time_s < b.time_s; });
  return placements;
}

}  // namespace

std::vector<score::Check> GrowthCheck::Run(CheckContext& context) const {
  const std::vector<double>& values = Values(context, p_.signal);
  const double period = context.rig().run.period_s;
  double amplitude[2] = {}, frequency = 0.0;
  for (int w = 0; w < 2; ++w) {
    const double begin_s = w == 0 ? p_.first_s : p_.second_s;
    const std::size_t begin = Row(context, begin_s), end = Row(context, begin_s + p_.window_s);
    if (end >= values.size() || end <= begin + 8) {
      return {Judge("growth", kName, std::numeric_limits<double>::quiet_NaN(), p_.tolerance_per_s, "1/s", p_.origin,
                    "a window does not lie within the run")};
    }
    const Tone tone = StrongestTone(std::span(values).subspan(begin, end - begin), period, p_.frequency_Hz, kNear_Hz);
    amplitude[w] = tone.amplitude;
    frequency = tone.frequency_Hz;
  }
  const double growth = std::log(amplitude[1] / amplitude[0]) / (p_.second_s - p_.first_s);
  const std::string what = fmt::format("{:.0f} Hz", p_.frequency_Hz);
  context.figures[fmt::format("growth_{:.0f}_hz_frequency", p_.frequency_Hz)] = {frequency, "Hz"};
  context.figures[fmt::format("growth_{:.0f}_hz_rate", p_.frequency_Hz)] = {growth, "1/s"};
  return {Judge("frequency of " + what, kName, std::abs(frequency - p_.frequency_Hz), p_.tolerance_Hz, "Hz", p_.origin,
                fmt::format("the run oscillates at {:.2f} Hz", frequency)),
          Judge("growth at " + what, kName, std::abs(growth - p_.growth_per_s), p_.tolerance_per_s, "1/s", p_.origin,
                fmt::format("from {:.3g} to {:.3g}: {:.2f} 1/s, the eigenvalue has {:.2f}", amplitude[0], amplitude[1],
                            growth, p_.growth_per_s))};
}

std::vector<score::Check> OscillationCheck::Run(CheckContext& context) const {
  const std::vector<double>& values = Values(context, p_.signal);
  const std::size_t begin = Row(context, p_.during_s[0]), end = Row(context, p_.during_s[1]);
  if (end >= values.size()) return {EndsBefore(context, kName, "during_s", p_.during_s[1], p_.origin)};
  const Tone tone = StrongestTone(std::span(values).subspan(begin, end - begin), context.rig().run.period_s,
                                  p_.frequency_Hz, p_.near_Hz);
  const std::string what = fmt::format("{} at {:.4g} Hz", p_.signal, p_.frequency_Hz);
  context.figures[fmt::format("{}_{:.0f}_hz", p_.signal, p_.frequency_Hz)] = {tone.frequency_Hz, "Hz"};
  context.figures[fmt::format("{}_{:.0f}_hz_amplitude", p_.signal, p_.frequency_Hz)] = {
      tone.amplitude, context.rig().outputs[static_cast<std::size_t>(FindOutput(context.rig(), p_.signal))].unit};
  return {Judge("frequency of " + what, kName, std::abs(tone.frequency_Hz - p_.frequency_Hz), p_.tolerance_Hz, "Hz",
                p_.origin, fmt::format("it oscillates at {:.2f} Hz", tone.frequency_Hz)),
          Judge("amplitude of " + what, kName, std::abs(tone.amplitude / p_.amplitude - 1.0), p_.tolerance, "1",
                p_.origin, fmt::format("{:.5g} is seen, {:.5g} expected", tone.amplitude, p_.amplitude))};
}

void OscillationCheck::Params::Check(Faults& faults) const {
  if (during_s.size() != 2 || !(during_s[1] > during_s[0])) faults.At("during_s", "write [from, to] with from < to");
}

std::vector<score::Check> PlacementsCheck::Run(CheckContext& context) const {
  if (Row(context, p_.load_from_s) >= context.samples().time.size())
    return {EndsBefore(context, kName, "load_from_s", p_.load_from_s, p_.origin)};
  const std::vector<Placement> all = PlacementsOf(context, p_.notches);
  std::vector<score::Check> checks;
  int after_load = 0;
  for (std::size_t i = 0; i < all.size(); ++i) {
    after_load += all[i].time_s >= p_.load_from_s ? 1 : 0;
    context.figures[fmt::format("notch_{}_hz", i + 1)] = {all[i].f_Hz, "Hz"};
    context.figures[fmt::format("placement_{}_s", i + 1)] = {all[i].time_s, "s"};
  }
  context.figures["placements_after_load"] = {static_cast<double>(after_load), "1"};
  for (std::size_t i = 0; i < p_.expected_Hz.size(); ++i) {
    const double value =
        i < all.size() ? std::abs(all[i].f_Hz - p_.expected_Hz[i]) : std::numeric_limits<double>::quiet_NaN();
    checks.push_back(Judge(fmt::format("placement {}", i + 1), kName, value, p_.tolerance_Hz, "Hz", p_.origin,
                           i < all.size() ? fmt::format("a filter went to {:.2f} Hz at {:.3f} s, expected {:.2f} Hz",
                                                        all[i].f_Hz, all[i].time_s, p_.expected_Hz[i])
                                          : fmt::format("{} placements in the whole run", all.size())));
  }
  const auto further = static_cast<double>(all.size()) - static_cast<double>(p_.expected_Hz.size());
  checks.push_back(Judge(
      "further placements", kName, std::max(0.0, further), 0.0, "1", p_.origin,
      all.empty() ? ""
                  : fmt::format("the last one went to {:.2f} Hz at {:.3f} s", all.back().f_Hz, all.back().time_s)));
  checks.push_back(
      Judge("placements after load", kName, after_load, 0.0, "1", p_.origin, "the load was taken for a resonance"));
  const std::vector<double>& signal = Values(context, p_.signal);
  const double end_s = context.samples().time.back(), last_s = all.empty() ? 0.0 : all.back().time_s;
  // Before the load the oscillation must die away; under load its level must stand.
  const double quiet_s = std::min(p_.load_from_s, end_s);
  if (!all.empty() && last_s + 2.0 * p_.window_s < quiet_s) {
    const double at = Rms(signal, Row(context, last_s), Row(context, last_s + p_.window_s));
    const double before = Rms(signal, Row(context, quiet_s - p_.window_s), Row(context, quiet_s));
    context.figures["decay_after_placement"] = {before / at, "1"};
    checks.push_back(Judge("quiet after the last placement", kName, before / at, 0.5, "1", p_.origin,
                           fmt::format("RMS {:.3g} at the placement, {:.3g} later", at, before)));
  }
  const double last = Rms(signal, Row(context, end_s - p_.window_s), Row(context, end_s));
  const double before = Rms(signal, Row(context, end_s - 2.0 * p_.window_s), Row(context, end_s - p_.window_s));
  checks.push_back(Judge("no growth at the end", kName, last / before, p_.growth_limit, "1", p_.origin,
                         fmt::format("RMS {:.3g}, then {:.3g}", before, last)));
  return checks;
}

std::vector<score::Check> WanderCheck::Run(CheckContext& context) const {
  std::vector<score::Check> checks;
  double furthest = 0.0;
  const std::size_t row = Row(context, p_.found_by_s);
  if (row >= context.samples().time.size()) return {EndsBefore(context, kName, "found_by_s", p_.found_by_s, p_.origin)};
  for (std::size_t i = 0; i < p_.notches.size() && i < p_.expected_Hz.size(); ++i) {
    const std::vector<double>& f = Values(context, p_.notches[i]);
    double wander = 0.0;
    for (std::size_t k = row; k < f.size(); ++k) wander = std::max(wander, std::abs(f[k] - f[row]));
    furthest = std::max(furthest, wander);
    context.figures[fmt::format("notch_{}_hz", i + 1)] = {f[row], "Hz"};
    context.figures[fmt::format("notch_{}_wander_hz", i + 1)] = {wander, "Hz"};
    checks.push_back(Judge("found " + p_.notches[i], kName, std::abs(f[row] - p_.expected_Hz[i]), p_.tolerance_Hz, "Hz",
                           p_.origin, fmt::format("at {:.1f} Hz", f[row])));
  }
  checks.push_back(Judge("confused by the load", kName, p_.wanders_Hz / std::max(furthest, 1e-9), 1.0, "1", p_.origin,
                         fmt::format("no filter moves by more than {:.1f} Hz", furthest)));
  return checks;
}

}  // namespace dynoproof
