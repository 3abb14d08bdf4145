#include "experiment/check_resonances.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "experiment/analysis.h"
#include "score/peaks.h"
#include "score/response.h"

namespace dynoproof {
namespace {

using score::Peak;

/// The peaks of the analytical frequency response, found on a grid by the same rule as those of the run.
Result<score::PeakList> ExpectedPeaks(const Rig& rig, const AnalysisSettings& settings, double from_Hz, double to_Hz,
                                      double prominence_db) {
  const Result<mechanics::TransferFunction> transfer = TransferOf(rig, settings);
  if (!transfer.ok()) return transfer.failure();
  constexpr int kPoints = 20'000;  // 0.1 Hz in a band of 2 kHz, a fraction of the narrowest resonance here
  std::vector<double> frequency(kPoints), magnitude(kPoints);
  for (int i = 0; i < kPoints; ++i) {
    frequency[i] = from_Hz + (to_Hz - from_Hz) * i / (kPoints - 1);
    // A command held for a period reaches the plant as the sine's samples times sinc(f period).
    const double x = std::numbers::pi * frequency[i] * rig.run.period_s;
    magnitude[i] = std::abs(transfer->AtFrequency(frequency[i]) * std::sin(x) / x);
  }
  return score::FindPeaks(frequency, magnitude, prominence_db);
}

}  // namespace

void ResonancesCheck::Params::Check(Faults& faults) const {
  if (band_Hz.size() != 2 || band_Hz[0] >= band_Hz[1]) faults.At("band_Hz", "write [from, to] with from < to");
}

std::vector<score::Check> ResonancesCheck::Run(CheckContext& context) const {
  const auto failed = [this](std::string why) {
    score::Check check;
    check.name = kName;
    check.kind = "resonance";
    check.value = std::numeric_limits<double>::quiet_NaN();
    check.limit = p_.tolerance_Hz;
    check.unit = "Hz";
    check.origin = p_.origin;
    check.explanation = std::move(why);
    return std::vector<score::Check>{check};
  };
  Diagnostics diagnostics;
  const std::optional<AnalysisSettings> settings = ReadAnalysis(context.plan(), context.rig(), diagnostics);
  if (!settings) return failed("the scenario has no section [analysis] with input and output");
  const Result<score::PeakList> expected =
      ExpectedPeaks(context.rig(), *settings, p_.band_Hz[0], p_.band_Hz[1], p_.prominence_db);
  if (!expected.ok()) return failed(expected.failure().ToString());
  if (!expected->ok() || expected->peaks.empty())
    return failed("the frequency response has no resonance: " + expected->reason);

  const score::Series input = SeriesOf(context.samples(), context.rig(), settings->input);
  const score::Series output = SeriesOf(context.samples(), context.rig(), settings->output);
  // Estimated somewhat beyond the band, so that a resonance at its edge is seen from both sides.
  const double margin = 0.02 * (p_.band_Hz[1] - p_.band_Hz[0]);
  const score::Response response =
      score::EstimateResponse(input.time_s, input.values, output.values,
                              {.from_hz = std::max(0.0, p_.band_Hz[0] - margin), .to_hz = p_.band_Hz[1] + margin});
  if (!response.ok()) return failed(response.reason);
  const score::PeakList found = score::FindPeaks(response.frequency_hz, response.Magnitude(), p_.prominence_db);
  if (!found.ok()) return failed(found.reason);

  std::vector<score::Check> checks;
  std::vector<bool> taken(found.peaks.size());
  int number = 0;
  for (const Peak& want : expected->peaks) {
    if (want.kind != score::PeakKind::kResonance) continue;
    ++number;
    std::size_t best = found.peaks.size();
    for (std::size_t i = 0; i < found.peaks.size(); ++i) {
      if (taken[i] || found.peaks[i].kind != score::PeakKind::kResonance) continue;
      const auto distance = [&](std::size_t k) { return std::abs(found.peaks[k].frequency_hz - want.frequency_hz); };
      if (best == found.peaks.size() || distance(i) < distance(best)) best = i;
    }
    const std::string name = fmt::format("resonance {} at {:.1f} Hz", number, want.frequency_hz);
    if (best == found.peaks.size()) {
      checks.push_back(failed(fmt::format("{}: the run shows no such peak", name)).front());
      checks.back().name = name;
      continue;
    }
    taken[best] = true;
    const Peak& seen = found.peaks[best];
    context.figures[fmt::format("resonance_{}_hz", number)] = {seen.frequency_hz, "Hz"};
    context.figures[fmt::format("resonance_{}_gain", number)] = {seen.height, "1"};
    checks.push_back(score::AtMost(name, "resonance", std::abs(seen.frequency_hz - want.frequency_hz), p_.tolerance_Hz,
                                   "Hz", p_.origin, fmt::format("seen at {:.2f} Hz", seen.frequency_hz)));
    // A resonance this narrow neither builds up while the sweep passes it nor rings down before the record ends: its
    // height in a chirp is the sweep's, not the plant's. Its position is.
    if (want.damping_ratio && 2.0 * *want.damping_ratio * want.frequency_hz < p_.narrowest_Hz) {
      checks.back().explanation += fmt::format("; {:.2f} Hz wide: too narrow to judge its height",
                                               2.0 * *want.damping_ratio * want.frequency_hz);
      continue;
    }
    checks.push_back(score::AtMost(name + ", height", "resonance", std::abs(seen.height / want.height - 1.0),
                                   p_.tolerance_gain, "1", p_.origin,
                                   fmt::format("gain {:.2f}, frequency response {:.2f}", seen.height, want.height)));
  }
  if (number == 0) return failed("the frequency response has no resonance in the band: choose another band_Hz");
  int extra = 0;
  std::string where;
  for (std::size_t i = 0; i < found.peaks.size(); ++i) {
    const Peak& peak = found.peaks[i];
    const bool inside = peak.frequency_hz >= p_.band_Hz[0] && peak.frequency_hz <= p_.band_Hz[1];
    if (taken[i] || !inside || peak.kind != score::PeakKind::kResonance) continue;
    ++extra;
    where += fmt::format(" {:.1f} Hz", peak.frequency_hz);
  }
  checks.push_back(score::AtMost("resonances nobody expects", "resonance", extra, 0.0, "1",
                                 "a linear line has the resonances of its frequency response and no others", where));
  return checks;
}

}  // namespace dynoproof
