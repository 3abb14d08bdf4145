#include "plugins/source/tones/tones.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace dynoproof::sources {
namespace {

constexpr std::uint64_t kPhaseStream = 1;  // keeps the phases apart from what else draws from the block's seed

double SumOf(const std::vector<Tone>& tones, double tau) {
  double sum = 0.0;
  for (const Tone& tone : tones) {
    const double cycles = tone.frequency_Hz * tau;
    sum += tone.amplitude * std::sin(2.0 * std::numbers::pi * (cycles - std::floor(cycles)) + tone.phase_rad);
  }
  return sum;
}

}  // namespace

PluginInfo SineSum::Info() {
  return {"source",
          "sine_sum",
          "a sum of given tones",
          "offset + sum_i amplitudes[i] sin(2 pi frequencies[i] (t - start_time) + phases[i])",
          "definition",
          {}};
}

PluginInfo Multisine::Info() {
  return {"source",
          "multisine",
          "a band of equal tones with seeded random phases",
          "offset + rms sqrt(2/lines) sum_i sin(2 pi f_i (t - start_time) + phase_i)",
          "Pintelon, Schoukens: System Identification, random-phase multisine",
          {}};
}

void SineSum::Params::Check(Faults& faults) const {
  if (amplitudes.empty() || amplitudes.size() != frequencies_Hz.size()) {
    faults.At("frequencies_Hz",
              fmt::format("{} amplitudes and {} frequencies", amplitudes.size(), frequencies_Hz.size()),
              "as many frequencies as amplitudes, at least one");
  }
  if (!phases_rad.empty() && phases_rad.size() != amplitudes.size()) {
    faults.At("phases_rad", fmt::format("{} phases for {} tones", phases_rad.size(), amplitudes.size()),
              "one for each tone, or leave the key out");
  }
}

void Multisine::Params::Check(Faults& faults) const {
  if (lines == 1 ? high_Hz != low_Hz : high_Hz <= low_Hz) {
    faults.At("high_Hz", fmt::format("{} line(s) from {} to {} Hz", lines, low_Hz, high_Hz),
              "high_Hz > low_Hz; equal for a single line");
  }
}

SineSum::SineSum(const Params& params) : offset_(params.offset), start_time_(params.start_time_s) {
  for (std::size_t i = 0; i < params.amplitudes.size(); ++i) {
    tones_.push_back(
        {params.amplitudes[i], params.frequencies_Hz[i], params.phases_rad.empty() ? 0.0 : params.phases_rad[i]});
  }
}

std::unique_ptr<SineSum> SineSum::Create(const Params& params, const dynoproof::Value& table, BuildContext& context) {
  WarnAboveHalfTheRate(*std::max_element(params.frequencies_Hz.begin(), params.frequencies_Hz.end()), "frequencies_Hz",
                       table, context);
  return std::make_unique<SineSum>(params);
}

double SineSum::Value(double time_s) const {
  const double tau = time_s - start_time_;
  return tau < -kTimeSlack ? 0.0 : offset_ + SumOf(tones_, tau);
}

Multisine::Multisine(const Params& params, const BuildContext& context)
    : offset_(params.offset), start_time_(params.start_time_s) {
  const double spacing = params.lines > 1 ? (params.high_Hz - params.low_Hz) / (params.lines - 1) : 0.0;
  const std::uint64_t seed = SeedOf(params.seed, context);
  for (int i = 0; i < params.lines; ++i) {
    tones_.push_back({params.rms * std::sqrt(2.0 / params.lines), params.low_Hz + i * spacing,
                      2.0 * std::numbers::pi * RandomUniform(seed, kPhaseStream, static_cast<std::uint64_t>(i))});
  }
}

std::unique_ptr<Multisine> Multisine::Create(const Params& params, const dynoproof::Value& table,
                                             BuildContext& context) {
  WarnAboveHalfTheRate(params.high_Hz, "high_Hz", table, context);
  return std::make_unique<Multisine>(params, context);
}

double Multisine::Value(double time_s) const {
  const double tau = time_s - start_time_;
  return tau < -kTimeSlack ? 0.0 : offset_ + SumOf(tones_, tau);
}

}  // namespace dynoproof::sources
