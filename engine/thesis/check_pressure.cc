#include "thesis/check_pressure.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "score/step_figures.h"
#include "thesis/constants.h"

namespace dynoproof {
namespace {

/// Where an input stands still after a change: samples [begin, end), and what it was before the change.
struct Phase {
  std::size_t ramp_begin, begin, end;
  double before, level;
};

std::vector<Phase> PhasesOf(const std::vector<double>& time, const std::vector<double>& input, double steady_s) {
  std::vector<Phase> phases;
  std::size_t last_end = 0;  // of the phase before: there the next ramp begins
  double before = input.empty() ? 0.0 : input.front();
  for (std::size_t begin = 0; begin < input.size();) {
    std::size_t end = begin + 1;
    while (end < input.size() && input[end] == input[begin]) ++end;
    if (time[end - 1] - time[begin] >= steady_s) {
      if (input[begin] != before) phases.push_back({last_end, begin, end, before, input[begin]});
      before = input[begin];
      last_end = end - 1;
    }
    begin = end;
  }
  return phases;
}

struct RampFigures {
  double overshoot_percent = 0.0, settling_s = 0.0, delay_s = 0.0, steady = kNaN;
};

/// The worst over all phases. A phase in which the output never comes to rest within the band settles in its whole
/// length.
RampFigures Analyse(const std::vector<double>& time, const std::vector<double>& input,
                    const std::vector<double>& output, const std::vector<double>* steady, const RampsCheck::Params& p) {
  RampFigures worst;
  int ramps = 0;
  for (const Phase& phase : PhasesOf(time, input, p.steady_s)) {
    const double step = phase.level - phase.before, band = 0.01 * p.band_percent * std::abs(step);
    std::size_t settled = phase.begin;
    // The output may overshoot the level on the ramp already.
    for (std::size_t k = phase.ramp_begin; k < phase.end; ++k) {
      worst.overshoot_percent = std::max(worst.overshoot_percent, 100.0 * (output[k] - phase.level) / step);
      if (k >= phase.begin && !(std::abs(output[k] - phase.level) <= band)) settled = k + 1;
    }
    worst.settling_s = std::max(worst.settling_s, time[std::min(settled, phase.end - 1)] - time[phase.begin]);
    if (steady != nullptr) {
      const std::size_t from = phase.end - std::max<std::size_t>(1, (phase.end - phase.begin) / 10);
      double mean = 0.0;
      for (std::size_t k = from; k < phase.end; ++k) mean += (*steady)[k] / static_cast<double>(phase.end - from);
      if (!(std::abs(mean - p.steady_at) <= std::abs(worst.steady - p.steady_at))) worst.steady = mean;
    }
    // A jump has no delay in this sense.
    const score::RampFigures ramp =
        phase.begin > phase.ramp_begin + 20
            ? score::AnalyseRamp({time, input}, {time, output}, {time[phase.ramp_begin], time[phase.begin], 0.5})
            : score::RampFigures();
    if (!ramp.ok() || phase.begin <= phase.ramp_begin + 20) continue;
    worst.delay_s = ramps == 0 ? ramp.delay_s : std::max(worst.delay_s, ramp.delay_s);
    ++ramps;
  }
  if (ramps == 0) worst.delay_s = kNaN;
  return worst;
}

/// The centred moving mean over `mean_s`; at the ends, where there is no whole one, the nearest.
std::vector<double> MovingMean(const std::vector<double>& time, const std::vector<double>& values, double mean_s) {
  std::vector<double> means(values.size());
  double sum = 0.0;
  std::size_t begin = 0, end = 0, first = values.size(), last = 0;
  for (std::size_t k = 0; k < values.size(); ++k) {
    while (end < values.size() && time[end] < time[k] + 0.5 * mean_s) sum += values[end++];
    while (time[begin] < time[k] - 0.5 * mean_s) sum -= values[begin++];
    means[k] = sum / static_cast<double>(end - begin);
    if (time[k] - 0.5 * mean_s < time.front() || time[k] + 0.5 * mean_s > time.back()) continue;
    first = std::min(first, k);
    last = k;
  }
  if (first > last) return means;  // a run that is shorter than one mean
  std::fill(means.begin(), means.begin() + static_cast<std::ptrdiff_t>(first), means[first]);
  std::fill(means.begin() + static_cast<std::ptrdiff_t>(last), means.end(), means[last]);
  return means;
}

score::Check NotMade(std::string name, const char* kind, const std::string& origin, std::string why) {
  score::Check check;
  check.name = std::move(name);
  check.kind = kind;
  check.value = check.limit = kNaN;
  check.origin = origin;
  check.explanation = std::move(why);
  return check;
}

}  // namespace

void RampsCheck::Params::Check(Faults& faults) const {
  if (!steady.empty() && !(steady_within > 0.0)) {
    faults.At("steady_within", "how far may the steady output be off?", "steady_within > 0");
  }
}

std::vector<std::string> RampsCheck::Signals() const {
  return p_.steady.empty() ? std::vector{p_.signal} : std::vector{p_.signal, p_.steady};
}

std::vector<score::Check> RampsCheck::Run(CheckContext& context) const {
  const std::string name = fmt::format("{} after ramps of {}", p_.signal, p_.reference);
  const Samples& samples = context.samples();
  const std::vector<double>& input = samples.inputs[FindInput(context.rig(), p_.reference)];
  const auto output = [&](const std::string& signal) { return &samples.outputs[FindOutput(context.rig(), signal)]; };
  if (PhasesOf(samples.time, input, p_.steady_s).empty()) {
    return {NotMade(
        name, kName, p_.origin,
        fmt::format("{} never stands still for {:g} s after a change before the run ends", p_.reference, p_.steady_s))};
  }
  const auto report = [&](const std::string& prefix, const RampFigures& figures) {
    context.figures[prefix + "overshoot_percent"] = {figures.overshoot_percent, "%"};
    context.figures[prefix + "settling_s"] = {figures.settling_s, "s"};
    if (std::isfinite(figures.delay_s)) context.figures[prefix + "delay_s"] = {figures.delay_s, "s"};
    if (!p_.steady.empty()) {
      context.figures[prefix + p_.steady + "_steady"] = {
          figures.steady, context.rig().outputs[FindOutput(context.rig(), p_.steady)].unit};
    }
  };
  const std::vector<double>* const steady = p_.steady.empty() ? nullptr : output(p_.steady);
  RampFigures own = Analyse(samples.time, input, *output(p_.signal), steady, p_);
  report("", own);
  if (p_.mean_s > 0.0) {
    own = Analyse(samples.time, input, MovingMean(samples.time, *output(p_.signal), p_.mean_s), steady, p_);
    report("mean.", own);
  }
  std::vector<score::Check> checks = {
      score::AtMost(p_.signal + " overshoot", kName, own.overshoot_percent, p_.overshoot_percent, "%", p_.origin),
      score::AtMost(p_.signal + " settling", kName, own.settling_s, p_.settling_s, "s", p_.origin)};
  if (!p_.steady.empty()) {
    checks.push_back(score::AtMost(p_.steady + " in steady phases", kName, std::abs(own.steady - p_.steady_at),
                                   p_.steady_within, context.rig().outputs[FindOutput(context.rig(), p_.steady)].unit,
                                   p_.origin, fmt::format("{:.3f}, wanted {:g}", own.steady, p_.steady_at)));
  }
  const Value* variants = context.plan().root.Find("variant");
  for (const std::string& variant : variants != nullptr ? KeysOf(*variants) : std::vector<std::string>()) {
    const auto of = [&](const std::string& signal) -> const std::vector<double>* {
      const trace::Signal* found = context.trace != nullptr ? context.trace->Find(signal + "_" + variant) : nullptr;
      return found != nullptr && found->values.size() == input.size() ? &found->values : nullptr;
    };
    if (of(p_.signal) == nullptr) continue;
    const std::vector<double>* const its_steady = p_.steady.empty() ? nullptr : of(p_.steady);
    report(variant + ".", Analyse(samples.time, input, *of(p_.signal), its_steady, p_));
    if (p_.mean_s > 0.0) {
      report(variant + ".mean.",
             Analyse(samples.time, input, MovingMean(samples.time, *of(p_.signal), p_.mean_s), its_steady, p_));
    }
  }
  for (const std::string& variant : p_.worse) {
    const auto found = context.figures.find(variant + (p_.mean_s > 0.0 ? ".mean." : ".") + "settling_s");
    const std::string what = variant + " is worse";
    if (found == context.figures.end()) {
      checks.push_back(NotMade(what, kName, p_.origin, "there is no such variant"));
      continue;
    }
    checks.push_back(score::AtMost(what, kName, own.settling_s / found->second.value, 1.0 / p_.worse_factor, "1",
                                   p_.origin, fmt::format("settles in {:.1f} s", found->second.value)));
  }
  return checks;
}

void BoundedCheck::Params::Check(Faults& faults) const {
  if (above.empty() && below.empty() && between.empty()) faults.At("signal", "no bound", "above, below or between");
  if (!between.empty() && (between.size() != 2 || between[0] >= between[1])) {
    faults.At("between", "write [from, to] with from < to");
  }
  if (!during_s.empty() && (during_s.size() != 2 || during_s[0] >= during_s[1])) {
    faults.At("during_s", "write [from, to] with from < to");
  }
}

std::vector<std::string> BoundedCheck::Signals() const {
  std::vector<std::string> signals = {p_.signal};
  for (const std::string& other : {p_.above, p_.below}) {
    if (!other.empty()) signals.push_back(other);
  }
  return signals;
}

std::vector<score::Check> BoundedCheck::Run(CheckContext& context) const {
  const auto output = [&](const std::string& signal) -> const std::vector<double>& {
    return context.samples().outputs[FindOutput(context.rig(), signal)];
  };
  const std::vector<double>& values = output(p_.signal);
  // Rows from `first` up to `end`; a stretch that the run does not have to its end holds nothing.
  const std::vector<double>& time = context.samples().time;
  std::size_t first = 0, end = values.size();
  if (!p_.during_s.empty()) {
    const auto row = [&time](double at_s) {
      return static_cast<std::size_t>(std::lower_bound(time.begin(), time.end(), at_s - 1e-9) - time.begin());
    };
    first = row(p_.during_s[0]);
    end = row(p_.during_s[1]) < values.size() ? row(p_.during_s[1]) + 1 : first;
  }
  double margin = first >= end ? kNaN : std::numeric_limits<double>::infinity(), when = 0.0;
  for (std::size_t k = first; k < end; ++k) {
    double here = std::numeric_limits<double>::infinity();
    const auto take = [&here](double distance) {
      if (!std::isnan(here) && !(distance >= here)) here = distance;  // a distance that is no number stays
    };
    if (!p_.above.empty()) take(values[k] - p_.above_factor * output(p_.above)[k]);
    if (!p_.below.empty()) take(p_.below_factor * output(p_.below)[k] - values[k]);
    if (!p_.between.empty()) {
      take(values[k] - p_.between[0]);
      take(p_.between[1] - values[k]);
    }
    if (here >= margin) continue;
    if (std::isnan(here)) {
      margin = kNaN;
      break;
    }
    margin = here;
    when = time[k];
  }
  const std::string unit = context.rig().outputs[FindOutput(context.rig(), p_.signal)].unit;
  std::string name = p_.signal;
  if (!p_.above.empty()) name += fmt::format(" above {:g} {}", p_.above_factor, p_.above);
  if (!p_.below.empty()) name += fmt::format(" below {:g} {}", p_.below_factor, p_.below);
  if (!p_.between.empty()) name += fmt::format(" between {:g} and {:g}", p_.between[0], p_.between[1]);
  if (!p_.during_s.empty()) name += fmt::format(" from {:g} to {:g} s", p_.during_s[0], p_.during_s[1]);
  Figure& least = context.figures.try_emplace(p_.signal + "_margin", Figure{margin, unit}).first->second;
  least.value = std::min(least.value, margin);
  score::Check check = score::AtMost(name, kName, std::max(0.0, -margin), 0.0, unit, p_.origin,
                                     fmt::format("nearest by {:.5g} at {:.4f} s", margin, when));
  if (!(margin > 0.0)) check.verdict = score::Verdict::kFail;  // on a bound is beyond it
  return {check};
}

}  // namespace dynoproof
