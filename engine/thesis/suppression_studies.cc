#include "thesis/suppression_studies.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <functional>
#include <limits>
#include <optional>

#include "base/random.h"
#include "base/within.h"
#include "control10k/spectrum.h"
#include "experiment/prepare.h"
#include "scenario/find.h"
#include "scenario/load.h"
#include "sim/solver.h"
#include "thesis/constants.h"
#include "thesis/limit_cycle.h"
#include "thesis/machine_loop.h"
#include "thesis/machine_scenario.h"
#include "thesis/study_parameters.h"
#include "thesis/suppression_loop.h"

namespace dynoproof {
namespace {

constexpr int kBlock = 128, kBins = 24;

SuppressionPlant PlantOf(const Value& parameters) {
  SuppressionPlant plant = R2RPlant(parameters.NumberOr("I5", 0.081), parameters.NumberOr("tau_s", 1e-3));
  plant.direct = parameters.NumberOr("direct", 0.0);
  return plant;
}

control10k::NotchCoefficients NotchAt(double f_Hz, double r) {
  control10k::NotchCoefficients c;
  control10k::DesignNotch(kTurn * f_Hz * kPeriod_s, r, c);
  return c;
}

using Notches = std::vector<control10k::NotchCoefficients>;
using LoopModes = std::function<Result<std::vector<FilteredLoopMode>>(double k_V, const Notches& notches)>;

std::unique_ptr<Prepared> PreparedScenario(const Registry& registry, const std::string& id, Diagnostics& diagnostics) {
  std::unique_ptr<Prepared> prepared;
  for (const std::string& file : FindScenarios(id, diagnostics)) prepared = Prepare(file, {}, registry, diagnostics);
  return prepared;
}

/// The loop that the parameters describe, by its gain and filters: that of a `scenario` with the machine, else of the
/// road-to-rig test bed, `machine_Hz` being the bandwidth of the machine's current control, absent where a lag stands for
/// both.
Result<LoopModes> LoopOf(const Registry& registry, const Value& parameters) {
  const double machine_Hz = parameters.NumberOr("machine_Hz", 0.0);
  const int delay = static_cast<int>(parameters.NumberOr("delay_samples", 0.0));
  const std::string scenario = parameters.TextOr("scenario");
  if (scenario.empty() && machine_Hz <= 0.0) {
    return LoopModes([plant = PlantOf(parameters), delay](double k_V, const Notches& notches) {
      return FilteredLoopModes(plant, k_V, delay, notches);
    });
  }
  Result<MachineLoop> loop = BadStudy("no loop");
  if (scenario.empty()) {
    loop = MachineLoop::Create(PlantOf(parameters), VascatDrive(machine_Hz), delay);
  } else {
    Diagnostics diagnostics;
    const std::unique_ptr<Prepared> prepared = PreparedScenario(registry, scenario, diagnostics);
    if (prepared == nullptr) return BadStudy(diagnostics.Format());
    loop = MachineLoopOf(prepared->plan, *prepared->rig, std::numeric_limits<double>::infinity());
  }
  if (!loop.ok()) return loop.failure();
  return LoopModes([made = *std::move(loop)](double k_V, const Notches& notches) { return made.Modes(k_V, notches); });
}

Result<std::vector<FilteredLoopMode>> ModesOf(const Registry& registry, const Value& parameters,
                                              const Notches& notches) {
  const Result<LoopModes> loop = LoopOf(registry, parameters);
  if (!loop.ok()) return loop.failure();
  return (*loop)(parameters.NumberOr("k_V", 9.7), notches);
}

/// Of the sampled loop's mode number `mode` (the fastest growing is 1): `quantity` = frequency or growth. Negative k_V:
/// the printed sign of the feedthrough.
Result<Figure> LoopModeStudy(const Registry& registry, const Value& parameters) {
  const auto modes = ModesOf(registry, parameters, {});
  if (!modes.ok()) return modes.failure();
  const auto index = static_cast<std::size_t>(parameters.NumberOr("mode", 1.0)) - 1;
  if (index >= modes->size()) return BadStudy("no such mode");
  const FilteredLoopMode& mode = (*modes)[index];
  return parameters.TextOr("quantity") == "growth" ? Figure{mode.growth_per_s, "1/s"} : Figure{mode.frequency_hz, "Hz"};
}

/// The limit cycle near `near_Hz` that the torque limit `T_limit_Nm` leaves, filters idle at 1500 Hz, by its describing
/// function: `quantity` = frequency, amplitude (of T_shaft) or border (the gain on the brink of stability).
Result<Figure> LimitCycleStudy(const Registry& registry, const Value& parameters) {
  const Result<LoopModes> loop = LoopOf(registry, parameters);
  if (!loop.ok()) return loop.failure();
  const auto idle = [&](double k_V) { return (*loop)(k_V, Notches(2, NotchAt(1500.0, 0.995))); };
  const Result<LimitCycle> cycle =
      PredictLimitCycle(idle, parameters.NumberOr("k_V", 9.7), parameters.NumberOr("near_Hz", 604.0),
                        parameters.NumberOr("T_limit_Nm", 4000.0));
  if (!cycle.ok()) return cycle.failure();
  const std::string quantity = parameters.TextOr("quantity");
  if (quantity == "amplitude") return Figure{cycle->T_shaft_Nm, "N m"};
  if (quantity == "border") return Figure{cycle->border_gain, "1"};
  return Figure{cycle->frequency_Hz, "Hz"};
}

/// How many modes of the loop grow.
Result<Figure> UnstableModes(const Registry& registry, const Value& parameters) {
  std::vector<control10k::NotchCoefficients> notches;
  const double r = parameters.NumberOr("radius", 0.995);
  for (const char* key : {"notch_1_Hz", "notch_2_Hz"}) {
    if (const double f = parameters.NumberOr(key, 0.0); f > 0.0) notches.push_back(NotchAt(f, r));
  }
  const auto modes = ModesOf(registry, parameters, notches);
  if (!modes.ok()) return modes.failure();
  return Figure{static_cast<double>(std::count_if(modes->begin(), modes->end(),
                                                  [](const auto& mode) { return mode.growth_per_s > 0.0; })),
                "1"};
}

/// The lowest or highest frequency (`end`) of a filter around `near_Hz`, in steps of 0.5 Hz, with which the loop is
/// stable while the other filter stands at `other_Hz`.
Result<Figure> NotchRange(const Registry&, const Value& parameters) {
  const double near = parameters.NumberOr("near_Hz", 832.0), other = parameters.NumberOr("other_Hz", 605.5);
  const double step = parameters.TextOr("end") == "low" ? -0.5 : 0.5, r = parameters.NumberOr("radius", 0.995);
  const SuppressionPlant plant = PlantOf(parameters);
  double last = std::numeric_limits<double>::quiet_NaN();
  for (double f = near; std::abs(f - near) < 50.0; f += step) {
    const auto modes = FilteredLoopModes(plant, parameters.NumberOr("k_V", 9.7), 0, {NotchAt(f, r), NotchAt(other, r)});
    if (!modes.ok()) return modes.failure();
    if (modes->front().growth_per_s >= 0.0) break;
    last = f;
  }
  return Figure{last, "Hz"};
}

/// Abs of the open loop at the mode nearest to `near_Hz` where its phase passes -180 degrees: the gain margin is its
/// inverse.
Result<Figure> LoopGainAtPhaseCrossing(const Registry&, const Value& parameters) {
  const double near = parameters.NumberOr("near_Hz", 605.0);
  std::vector<double> f;
  for (double x = near - 12.0; x <= near + 12.0; x += 0.05) f.push_back(x);
  std::vector<control10k::NotchCoefficients> notches;
  for (const char* key : {"notch_1_Hz", "notch_2_Hz"}) {
    if (const double at = parameters.NumberOr(key, 0.0); at > 0.0) notches.push_back(NotchAt(at, 0.995));
  }
  const auto loop = OpenLoop(PlantOf(parameters), parameters.NumberOr("k_V", 9.7), 0, notches, f);
  if (!loop.ok()) return loop.failure();
  double largest = 0.0;
  for (std::size_t i = 1; i < f.size(); ++i) {
    const std::complex<double> a = (*loop)[i - 1], b = (*loop)[i];
    if (a.imag() * b.imag() > 0.0 || a.real() + b.real() > 0.0) continue;
    largest = std::max(largest, std::abs(0.5 * (a + b)));
  }
  return Figure{largest, "1"};
}

double ExactLobe(double delta, int block) {
  std::complex<double> sum = 0.0;
  for (int n = 0; n < block; ++n) {
    const double x = kTurn * n / block;
    sum += (0.42 - 0.5 * std::cos(x) + 0.08 * std::cos(2.0 * x)) * std::polar(1.0, x * delta);
  }
  return std::abs(sum);
}

/// Largest error of (5.27) within half a bin, in bins.
Result<Figure> OffsetError(const Registry&, const Value&) {
  double worst = 0.0;
  for (double d = -0.5; d <= 0.5; d += 0.001) {
    const double b =
        control10k::BlackmanOffset(ExactLobe(d + 1, kBlock), ExactLobe(d, kBlock), ExactLobe(d - 1, kBlock));
    worst = std::max(worst, std::abs(b - d));
  }
  return Figure{worst, "1"};
}

/// Largest relative error of (5.28) up to `within` bins, N = 100 as in Fig. 5.14.
Result<Figure> LobeError(const Registry&, const Value& parameters) {
  double worst = 0.0;
  const double within = parameters.NumberOr("within", 0.5);
  for (double d = 0.0; d <= within + 1e-9; d += 0.001) {
    worst = std::max(worst, std::abs(control10k::BlackmanLobe(d) / (ExactLobe(d, 100) / ExactLobe(0.0, 100)) - 1.0));
  }
  return Figure{worst, "1"};
}

/// Condition 3 on a clean tone: the offset from which 5 % on both neighbours rejects it.
Result<Figure> FirstRejected(const Registry&, const Value& parameters) {
  const double tolerance = parameters.NumberOr("tolerance", 0.05);
  for (double d = 0.0; d <= 0.5; d += 0.0005) {
    const double m[3] = {ExactLobe(d + 1, kBlock), ExactLobe(d, kBlock), ExactLobe(d - 1, kBlock)};
    control10k::Peak peak;
    peak.bin = 2;
    peak.offset = control10k::BlackmanOffset(m[0], m[1], m[2]);
    if (!Within(control10k::LobeMisfit(m, peak, -1), tolerance) ||
        !Within(control10k::LobeMisfit(m, peak, 1), tolerance)) {
      return Figure{d, "1"};
    }
  }
  return Figure{0.5, "1"};
}

/// Quantile of the estimator's errors over 4000 random tones (160 ... 1790 Hz, 20 ... 1000 N m, any phase, white noise
/// of `noise` times the amplitude): `of` = frequency [Hz] or amplitude [relative].
Result<Figure> EstimatorError(const Registry&, const Value& parameters) {
  const double noise = parameters.NumberOr("noise", 0.01), quantile = parameters.NumberOr("quantile", 0.5);
  control10k::GoertzelTables tables;
  control10k::MakeTables(kBlock, kBins, tables);
  std::vector<double> errors;
  for (int i = 0; i < 4000; ++i) {
    const auto uniform = [i](int stream) { return RandomUniform(7, static_cast<std::uint64_t>(stream), i); };
    const double f = 160.0 + 1630.0 * uniform(0), a = 20.0 * std::pow(50.0, uniform(1)), phase = kTurn * uniform(2);
    control10k::Goertzel bank;
    for (int n = 0; n < kBlock; ++n) {
      bank.Step(tables, a * (std::sin(kTurn * f * kPeriod_s * n + phase) +
                             noise * RandomNormal(8, static_cast<std::uint64_t>(i), static_cast<std::uint64_t>(n))));
    }
    double m[control10k::kMaxBins];
    bank.Magnitudes(tables, m);
    const control10k::Peak peak = control10k::FindPeak(m, kBins, kBlock, kPeriod_s);
    errors.push_back(parameters.TextOr("of") == "amplitude" ? std::abs(peak.amplitude / a - 1.0)
                                                            : std::abs(peak.frequency_Hz - f));
  }
  std::sort(errors.begin(), errors.end());
  const auto place = static_cast<std::size_t>(quantile * static_cast<double>(errors.size() - 1));
  return Figure{errors[place], parameters.TextOr("of") == "amplitude" ? "1" : "Hz"};
}

/// (D.7) against the response of the filter as it runs: relative difference.
Result<Figure> NyquistGainStudy(const Registry&, const Value& parameters) {
  const double f = parameters.NumberOr("f_Hz", 156.0), r = parameters.NumberOr("radius", 0.995);
  return Figure{control10k::NyquistGain(kTurn * f * kPeriod_s, r), "1"};
}

/// Largest difference between the two sides of footnote 3 of chapter 5: H~(nu_0) H~(-nu_0) = (1 + r)^2 / (4 K) H.
Result<Figure> ComplexPair(const Registry&, const Value&) {
  const double nu_0 = 0.5, r = 0.995, c = std::cos(nu_0);
  const double K = (1.0 + r * r - 2.0 * r * c) / (2.0 - 2.0 * c);
  const auto half = [r](double at, std::complex<double> z) {
    const std::complex<double> e = std::polar(1.0, at) / z;
    return 0.5 * (1.0 - (e - r) / (1.0 - r * e));
  };
  double worst = 0.0;
  for (double nu = 0.01; nu < 3.1; nu += 0.037) {
    const std::complex<double> z = std::polar(1.0, nu), i = 1.0 / z;
    const std::complex<double> H = K * (1.0 - 2.0 * c * i + i * i) / (1.0 - 2.0 * r * c * i + r * r * i * i);
    worst = std::max(worst, std::abs(half(nu_0, z) * half(-nu_0, z) - (1.0 + r) * (1.0 + r) / (4.0 * K) * H));
  }
  return Figure{worst, "1"};
}

/// Whether an actuator explains both the simulation (setup 1 at 9.7: exactly the first two modes grow) and Experiment I
/// (setup 3: stable at k_V = 1, not at 4.5, and one filter with r = 0.995 within 15 Hz of its mode stabilises it).
Result<bool> ExplainsBoth(double tau, double direct, int delay) {
  const auto plant = [&](double I5) {
    SuppressionPlant made = R2RPlant(I5, tau);
    made.direct = direct;
    return made;
  };
  const auto first = FilteredLoopModes(plant(0.081), 9.7, delay, {});
  if (!first.ok()) return first.failure();
  std::vector<double> growing;
  for (const FilteredLoopMode& mode : *first) {
    if (mode.growth_per_s > 0.0) growing.push_back(mode.frequency_hz);
  }
  std::sort(growing.begin(), growing.end());
  if (growing.size() != 2 || std::abs(growing[0] - 605.0) > 20.0 || std::abs(growing[1] - 832.0) > 20.0) return false;
  const auto quiet = FilteredLoopModes(plant(0.311), 1.0, delay, {});
  const auto loud = FilteredLoopModes(plant(0.311), 4.5, delay, {});
  if (!quiet.ok() || !loud.ok()) return BadStudy("an eigenvalue problem failed");
  if (quiet->front().growth_per_s >= 0.0 || loud->front().growth_per_s <= 0.0) return false;
  for (double shift = -15.0; shift <= 15.0; shift += 1.0) {
    const auto filtered =
        FilteredLoopModes(plant(0.311), 4.5, delay, {NotchAt(loud->front().frequency_hz + shift, 0.995)});
    if (!filtered.ok()) return filtered.failure();
    if (filtered->front().growth_per_s < 0.0) return true;
  }
  return false;
}

/// How many of the first-order lags from 0.05 to 4 ms with 0 to 2 samples of delay explain both; with `direct` > 0 the
/// lags of which that part of the torque follows at once.
Result<Figure> LagsExplainingBoth(const Registry&, const Value& parameters) {
  const double direct = parameters.NumberOr("direct", 0.0);
  int count = 0;
  for (int delay = 0; delay <= static_cast<int>(parameters.NumberOr("delays", 2.0)); ++delay) {
    for (double tau = 5e-5; tau < 4e-3; tau *= 1.1) {
      const Result<bool> good = ExplainsBoth(tau, direct, delay);
      if (!good.ok()) return good.failure();
      count += *good ? 1 : 0;
    }
  }
  return Figure{static_cast<double>(count), "1"};
}

/// Smallest r of a trial filter at the mode of setup 1 (k_V = 9.7, 832 Hz) and by how much it moves the oscillation
/// there: what Appendix E builds on. Shift in Hz for a radius `radius`.
Result<Figure> ProbeShift(const Registry&, const Value& parameters) {
  const SuppressionPlant plant = PlantOf(parameters);
  const auto before = FilteredLoopModes(plant, parameters.NumberOr("k_V", 9.7), 0, {});
  if (!before.ok()) return before.failure();
  const double f = before->front().frequency_hz;
  const auto after =
      FilteredLoopModes(plant, parameters.NumberOr("k_V", 9.7), 0,
                        {NotchAt(f + parameters.NumberOr("miss_Hz", 0.0), parameters.NumberOr("radius", 0.999))});
  if (!after.ok()) return after.failure();
  double nearest = INFINITY;
  std::vector<FilteredLoopMode> ordered = *after;
  for (const FilteredLoopMode& mode : ordered) {
    if (mode.growth_per_s <= 0.0) continue;
    if (std::abs(mode.frequency_hz - f) < std::abs(nearest)) nearest = mode.frequency_hz - f;
  }
  return Figure{std::isfinite(nearest) ? std::abs(nearest) : 0.0, "Hz"};
}

/// The oscillation of `signal` in the last 0.1 s of a run: its `quantity` amplitude (largest value) or frequency (of
/// the largest component between 100 and 2000 Hz).
Result<Figure> LastOscillation(const Registry& registry, const Value& parameters) {
  Diagnostics diagnostics;
  const std::unique_ptr<Prepared> prepared = PreparedScenario(registry, parameters.TextOr("scenario"), diagnostics);
  if (prepared == nullptr) return BadStudy(diagnostics.Format());
  const Rig& rig = *prepared->rig;
  const auto solver = MakeSolver(rig.run.solver, rig);
  if (!solver.ok()) return solver.failure();
  const Result<Samples> samples = Simulate(rig, **solver);
  if (!samples.ok()) return samples.failure();
  const int output = FindOutput(rig, parameters.TextOr("signal"));
  if (output < 0) return BadStudy("the scenario has no such output");
  const std::vector<double>& values = samples->outputs[static_cast<std::size_t>(output)];
  const double period = rig.run.period_s;
  const auto count = std::min(values.size(), static_cast<std::size_t>(std::lround(0.1 / period)));
  const double* last = values.data() + values.size() - count;
  if (parameters.TextOr("quantity") == "amplitude") {
    double largest = 0.0;
    for (std::size_t i = 0; i < count; ++i) largest = std::max(largest, std::abs(last[i]));
    return Figure{largest, "N m"};
  }
  const auto component = [&](double f) {
    std::complex<double> sum = 0.0;
    for (std::size_t i = 0; i < count; ++i) {
      const double x = kTurn * static_cast<double>(i) / static_cast<double>(count);
      const double window = 0.42 - 0.5 * std::cos(x) + 0.08 * std::cos(2.0 * x);
      sum += last[i] * window * std::polar(1.0, -kTurn * f * period * static_cast<double>(i));
    }
    return std::abs(sum);
  };
  const auto strongest = [&](double from, double to, double step) {
    double best = from, most = -1.0;
    for (double f = from; f <= to; f += step) {
      if (const double now = component(f); now > most) {
        most = now;
        best = f;
      }
    }
    return best;
  };
  const double coarse = strongest(100.0, 2000.0, 5.0);
  return Figure{strongest(coarse - 5.0, coarse + 5.0, 0.05), "Hz"};
}

}  // namespace

std::map<std::string, Study, std::less<>> SuppressionStudies() {
  return {
      {"complex_notch_pair", ComplexPair},
      {"condition_3_first_rejected", FirstRejected},
      {"estimator_error", EstimatorError},
      {"interpolation_offset_error", OffsetError},
      {"lags_explaining_both", LagsExplainingBoth},
      {"last_oscillation", LastOscillation},
      {"limit_cycle", LimitCycleStudy},
      {"lobe_error", LobeError},
      {"loop_gain_at_phase_crossing", LoopGainAtPhaseCrossing},
      {"loop_mode", LoopModeStudy},
      {"notch_range", NotchRange},
      {"nyquist_gain", NyquistGainStudy},
      {"probe_shift", ProbeShift},
      {"unstable_modes", UnstableModes},
  };
}

}  // namespace dynoproof
