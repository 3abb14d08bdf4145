#include "thesis/check_load_step.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

namespace dynoproof {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

double Mean(const std::vector<double>& values, std::size_t from, std::size_t to) {
  return std::accumulate(values.begin() + from, values.begin() + to, 0.0) / static_cast<double>(to - from);
}

/// The one sample at which the input changes; 0 where it changes never or more than once.
std::size_t StepOf(const std::vector<double>& input) {
  std::size_t step = 0;
  for (std::size_t k = 1; k < input.size(); ++k) {
    if (input[k] == input[k - 1]) continue;
    if (step != 0) return 0;
    step = k;
  }
  return step;
}

}  // namespace

void LoadStepCheck::Params::Check(Faults& faults) const {
  if (drop_percent.size() != 2 || drop_percent[0] >= drop_percent[1]) {
    faults.At("drop_percent", "write [from, to] with from < to");
  }
}

std::vector<score::Check> LoadStepCheck::Run(CheckContext& context) const {
  const std::vector<double>& time = context.samples().time;
  const auto output = [&](const std::string& name) -> const std::vector<double>& {
    return context.samples().outputs[FindOutput(context.rig(), name)];
  };
  const std::vector<double>&speed = output(p_.speed), &power = output(p_.power);
  const std::size_t step = StepOf(context.samples().inputs[FindInput(context.rig(), p_.load)]);
  const auto not_made = [&](std::string why) {
    score::Check check;
    check.name = p_.speed + " after a step of " + p_.load;
    check.kind = kName;
    check.value = check.limit = kNaN;
    check.origin = p_.origin;
    check.explanation = std::move(why);
    return std::vector{check};
  };
  if (step == 0) return not_made(p_.load + " does not step once");
  const auto at = [&](double time_s) {
    return static_cast<std::size_t>(std::lower_bound(time.begin(), time.end(), time_s) - time.begin());
  };
  const double begin_s = time[step], end_s = time.back();
  if (begin_s < 1.0 || end_s < begin_s + p_.peak_within_s + 1.0) {
    return not_made("a second is needed before the step, and one more than peak_within_s behind it");
  }
  for (const auto* values : {&speed, &power}) {
    if (!std::all_of(values->begin(), values->end(), [](double value) { return std::isfinite(value); })) {
      return not_made("a sample is no number");
    }
  }
  const double before = Mean(speed, at(begin_s - 1.0), step), power_before = Mean(power, at(begin_s - 1.0), step);
  const std::size_t last = at(end_s - 1.0),
                    deepest = std::min_element(speed.begin() + step, speed.end()) - speed.begin();
  const double drop = 100.0 * (before - speed[deepest]) / before;
  std::size_t settled = step;
  for (std::size_t k = step; k < speed.size(); ++k) {
    if (!(std::abs(speed[k] - before) <= 0.01 * p_.band_percent * before)) settled = k + 1;
  }
  const bool recovers = settled < speed.size();
  const double recovery = recovers ? time[settled] - begin_s : std::numeric_limits<double>::infinity();
  const std::size_t first = at(begin_s + p_.peak_within_s);
  const std::size_t until = std::max(first + 1, recovers ? settled : speed.size());
  const double peak = *std::max_element(power.begin() + step, power.begin() + first);
  const double dip = *std::min_element(power.begin() + first, power.begin() + until);
  const double end = Mean(power, last, power.size()), rise = end - power_before;

  context.figures["speed_drop_percent"] = {drop, "%"};
  context.figures["drop_s"] = {time[deepest] - begin_s, "s"};
  context.figures["recovery_s"] = {recovers ? recovery : end_s - begin_s, "s"};
  context.figures["speed_end_percent"] = {100.0 * (Mean(speed, last, speed.size()) - before) / before, "%"};
  context.figures["power_before_W"] = {power_before, "W"};
  context.figures["power_peak_W"] = {peak, "W"};
  context.figures["power_dip_W"] = {dip, "W"};
  context.figures["power_end_W"] = {end, "W"};
  const double middle = 0.5 * (p_.drop_percent[0] + p_.drop_percent[1]);
  std::vector<score::Check> checks = {
      score::AtMost(p_.speed + " drop", kName, std::abs(drop - middle), p_.drop_percent[1] - middle, "%", p_.origin,
                    fmt::format("{:.3f} % at {:.3f} s behind the step; allowed {:g} to {:g} %", drop,
                                time[deepest] - begin_s, p_.drop_percent[0], p_.drop_percent[1])),
      score::AtMost(p_.speed + " recovery", kName, recovery, p_.recovery_s, "s", p_.origin),
      score::AtMost(p_.power + " first rise", kName, 100.0 * std::abs(peak - end) / std::abs(rise), p_.end_percent, "%",
                    p_.origin,
                    fmt::format("from {:.4g} to {:.4g} at once, {:.4g} in the end", power_before, peak, end))};
  if (p_.dip_percent > 0.0) {
    const double taken = 100.0 * (std::min(peak, end) - dip) / rise;
    // At least: what is missing of it.
    checks.push_back(score::AtMost(p_.power + " taken back", kName, std::max(0.0, p_.dip_percent - taken), 0.0, "%",
                                   p_.origin,
                                   fmt::format("by {:.2f} % of the rise, {:g} % wanted", taken, p_.dip_percent)));
    if (!(taken >= p_.dip_percent)) checks.back().verdict = score::Verdict::kFail;
  }
  return checks;
}

}  // namespace dynoproof
