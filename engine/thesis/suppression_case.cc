#include "thesis/suppression_case.h"

#include <algorithm>
#include <cmath>

#include "base/random.h"
#include "base/subnormals.h"
#include "thesis/constants.h"

namespace dynoproof {
namespace {

constexpr double kLoadFrom_s = 0.2, kRight_Hz = 20.0;
enum Stream : std::uint64_t { kNoise = 12, kBroad = 13, kSearch = 14 };

control10k::CoreConfig Config(double probe_gamma) {
  control10k::CoreConfig config;
  config.speed = {20.0, 20.0, 4000.0};  // as scenarios/suppression
  config.suppression.probe_gamma = probe_gamma;
  return config;
}

double Printed(double t) { return 65.0 - 400.0 * std::sin(kTurn * 225.0 * t) + 300.0 * std::sin(kTurn * 450.0 * t); }

/// The load at a step; `tone_Hz`: of the steady tones.
double LoadAt(const SuppressionParameters& p, double tone_Hz, std::uint64_t seed, std::int64_t n) {
  const double t = static_cast<double>(n) * kPeriod_s, a = p.load_amplitude_Nm;
  if (t < kLoadFrom_s || p.load == "quiet") return 0.0;
  if (p.load == "printed") return Printed(t);
  if (p.load == "gear_changes")  // another level every 0.4 s
    return a * (2.0 * RandomUniform(seed, kBroad, static_cast<std::uint64_t>(t / 0.4)) - 1.0);
  if (p.load == "engine_sweep") {  // from 50 Hz to 1000 Hz within 1.5 s, through the resonances, then back
    const double T = 1.5, tau = std::fmod(t - kLoadFrom_s, 2.0 * T), rise = 950.0 / T;
    const double phase = tau < T
                             ? 50.0 * tau + 0.5 * rise * tau * tau
                             : 50.0 * T + 0.5 * rise * T * T + 1000.0 * (tau - T) - 0.5 * rise * (tau - T) * (tau - T);
    return a * std::sin(kTurn * phase);
  }
  if (p.load == "broadband") return a * RandomNormal(seed, kBroad, static_cast<std::uint64_t>(n));
  return a * std::sin(kTurn * tone_Hz * t);
}

/// The filters as they stand.
std::vector<control10k::NotchCoefficients> FiltersOf(const SuppressionLoop& loop) {
  std::vector<control10k::NotchCoefficients> filters;
  for (int i = 0; i < loop.core().suppression().filters(); ++i) {
    filters.push_back(loop.core_state().suppression.notch[i].c);
  }
  return filters;
}

Result<std::vector<double>> Growing(const SuppressionPlant& plant, double k_V, int delay,
                                    const std::vector<control10k::NotchCoefficients>& filters) {
  const Result<std::vector<FilteredLoopMode>> modes = FilteredLoopModes(plant, k_V, delay, filters);
  if (!modes.ok()) return modes.failure();
  std::vector<double> growing;
  for (const FilteredLoopMode& mode : *modes) {
    if (mode.growth_per_s > 0.0) growing.push_back(mode.frequency_hz);
  }
  return growing;
}

bool Near(const std::vector<double>& list, double f) {
  return std::any_of(list.begin(), list.end(), [f](double one) { return std::abs(one - f) < kRight_Hz; });
}

}  // namespace

Result<SuppressionRun> RunCase(const SuppressionParameters& p, std::uint64_t seed) {
  const FlushSubnormals flush;
  SuppressionPlant plant = R2RPlant(p.I5_kg_m2, p.tau_a_s);
  for (mechanics::Edge& edge : plant.network.edges) {
    edge.stiffness *= edge.name == "k3" ? p.k3 : edge.name == "k4" ? p.k4 : p.rotor;
    edge.damping *= p.damping;
  }
  // The filters that are not in use stand at 1500 Hz.
  control10k::NotchCoefficients idle;
  control10k::DesignNotch(kTurn * 1500.0 * kPeriod_s, 0.995, idle);
  const Result<std::vector<double>> unstable = Growing(plant, p.k_V, p.delay_samples, {idle, idle});
  if (!unstable.ok()) return unstable.failure();
  SuppressionRun run;
  run.unstable_Hz = *unstable;
  const double centre = unstable->empty() ? 600.0 : unstable->front();
  const double tone_Hz = p.load == "near_tone" ? centre + p.tone_side * p.tone_offset_Hz : p.tone_Hz;

  Result<SuppressionLoop> made = SuppressionLoop::Create(plant, Config(p.probe_gamma), p.delay_samples);
  if (!made.ok()) return made.failure();
  SuppressionLoop& loop = *made;
  std::vector<bool> found(unstable->size(), false);
  const auto steps = static_cast<std::int64_t>(p.duration_s / kPeriod_s);
  double placements = 0.0;
  for (std::int64_t n = 0; n < steps; ++n) {
    const double noise = p.noise_Nm * RandomNormal(seed, kNoise, static_cast<std::uint64_t>(n));
    const bool block_ends = loop.core_state().suppression.bank.count + 1.0 >= 128.0;
    std::vector<control10k::NotchCoefficients> before;
    if (block_ends) before = FiltersOf(loop);
    loop.Step(LoadAt(p, tone_Hz, seed, n), noise, p.k_V, true);
    run.peak_Nm = std::max(run.peak_Nm, std::abs(loop.T_shaft_Nm()));
    const control10k::SuppressionState& state = loop.core_state().suppression;
    if (state.placements == placements) continue;
    placements = state.placements;
    const double f = state.f_Hz[static_cast<int>(state.last_placed)], t = static_cast<double>(n) * kPeriod_s;
    // A probe has turned the phase already: the modes it was started for are those of the loop without it.
    if (p.probe_gamma > 0.0) before[static_cast<std::size_t>(state.last_placed)] = {};
    const auto growing = Growing(plant, p.k_V, p.delay_samples, before);
    if (!growing.ok()) return growing.failure();
    run.placements.push_back({t, f, Near(*growing, f)});
    for (std::size_t i = 0; i < found.size(); ++i) {
      if (found[i] || std::abs((*unstable)[i] - f) >= kRight_Hz) continue;
      found[i] = true;
      ++run.found;
      run.times.push_back(t);
    }
  }
  const auto growing = Growing(plant, p.k_V, p.delay_samples, FiltersOf(loop));
  if (!growing.ok()) return growing.failure();
  run.stable_at_end = growing->empty();
  return run;
}

Result<SmallestTone> SmallestMisleadingTone(double k_V, double from_Hz, double to_Hz, double step_Hz) {
  const FlushSubnormals flush;
  SmallestTone best{0.0, INFINITY};
  for (double f = from_Hz; f <= to_Hz; f += step_Hz) {
    // T_shaft is proportional to the tone: its amplitude for 1 N m gives the tone that reaches T_min; then it is tried.
    double amplitude = 1.0;
    for (const bool trial : {false, true}) {
      Result<SuppressionLoop> loop = SuppressionLoop::Create(R2RPlant(), Config(0.0));
      if (!loop.ok()) return loop.failure();
      double largest = 0.0;
      for (int n = 0; n < 8000; ++n) {
        loop->Step(amplitude * std::sin(kTurn * f * n * kPeriod_s), 0.0, k_V, trial);
        if (n > 6000) largest = std::max(largest, std::abs(loop->T_shaft_Nm()));
      }
      if (!trial) {
        amplitude = 1.05 * 20.0 / largest;  // 5 % above the threshold
        if (amplitude >= best.amplitude_Nm) break;
      } else if (loop->core_state().suppression.placements > 0.0) {
        best = {f, amplitude};
      }
    }
  }
  return best;
}

Result<WorstLoad> SearchWorstLoad(double most_Nm, int tries, std::uint64_t seed) {
  WorstLoad worst;
  for (int i = 0; i < tries; ++i) {
    const auto uniform = [&](int k) { return RandomUniform(seed, kSearch, static_cast<std::uint64_t>(i * 4 + k)); };
    double f = 160.0 + 1500.0 * uniform(0), a = most_Nm * uniform(1);
    if (i > tries / 2 && worst.tried > 0) {  // the second half stays near the worst so far
      f = std::clamp(worst.frequency_Hz + 40.0 * (uniform(0) - 0.5), 160.0, 1790.0);
      a = std::clamp(worst.amplitude_Nm + 0.3 * most_Nm * (uniform(1) - 0.5), 0.0, most_Nm);
    }
    const FlushSubnormals flush;
    Result<SuppressionLoop> loop = SuppressionLoop::Create(R2RPlant(), Config(0.0));
    if (!loop.ok()) return loop.failure();
    double placed_before = 0.0, peak = 0.0;
    for (int n = 0; n < 30000; ++n) {
      const double t = n * kPeriod_s;
      if (n == 10000) placed_before = loop->core_state().suppression.placements;
      loop->Step(t >= 1.0 ? a * std::sin(kTurn * f * t) : 0.0,
                 RandomNormal(seed, kNoise, static_cast<std::uint64_t>(n)), 9.7, true);
      if (t >= 1.0) peak = std::max(peak, std::abs(loop->T_shaft_Nm()));
    }
    const auto growing = Growing(R2RPlant(), 9.7, 0, FiltersOf(*loop));
    if (!growing.ok()) return growing.failure();
    const WorstLoad one{
        f, a, peak, static_cast<int>(loop->core_state().suppression.placements - placed_before), !growing->empty(), 0};
    const auto badness = [](const WorstLoad& w) {
      return (w.unstable_at_end ? 1e6 : 0.0) + 1e3 * w.placements_after_load + w.peak_Nm / 1e3;
    };
    if (worst.tried == 0 || badness(one) > badness(worst)) {
      const int tried = worst.tried;
      worst = one;
      worst.tried = tried;
    }
    ++worst.tried;
  }
  return worst;
}

}  // namespace dynoproof
