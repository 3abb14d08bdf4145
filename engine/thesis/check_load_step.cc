#include "thesis/check_load_step.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "thesis/constants.h"

namespace dynoproof {
namespace {

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

/// What a speed and a power do after the step: the figures of the check, by name.
struct Answer {
  double drop, drop_s, recovery, speed_end, before, peak, dip, end;
};

std::size_t RowAt(const std::vector<double>& time, double time_s) {
  return static_cast<std::size_t>(std::lower_bound(time.begin(), time.end(), time_s) - time.begin());
}

/// Of a run that is long enough; recovery is infinite where there is none.
Answer AnswerOf(const std::vector<double>& time, const std::vector<double>& speed, const std::vector<double>& power,
                std::size_t step, double peak_within_s, double band_percent) {
  const double begin_s = time[step], end_s = time.back();
  const std::size_t from = RowAt(time, begin_s - 1.0), last = RowAt(time, end_s - 1.0);
  const double before = Mean(speed, from, step);
  const std::size_t deepest = std::min_element(speed.begin() + step, speed.end()) - speed.begin();
  std::size_t settled = step;
  for (std::size_t k = step; k < speed.size(); ++k) {
    if (!(std::abs(speed[k] - before) <= 0.01 * band_percent * before)) settled = k + 1;
  }
  const bool recovers = settled < speed.size();
  const std::size_t first = RowAt(time, begin_s + peak_within_s);
  const std::size_t until = std::max(first + 1, recovers ? settled : speed.size());
  return {100.0 * (before - speed[deepest]) / before,
          time[deepest] - begin_s,
          recovers ? time[settled] - begin_s : std::numeric_limits<double>::infinity(),
          100.0 * (Mean(speed, last, speed.size()) - before) / before,
          Mean(power, from, step),
          *std::max_element(power.begin() + step, power.begin() + first),
          *std::min_element(power.begin() + first, power.begin() + until),
          Mean(power, last, power.size())};
}

bool AllNumbers(const std::vector<double>& values) {
  return std::all_of(values.begin(), values.end(), [](double value) { return std::isfinite(value); });
}

void Report(CheckContext& context, const std::string& prefix, const Answer& answer, double longest_s) {
  const auto put = [&](const char* name, double value, const char* unit) {
    context.figures[prefix + name] = {value, unit};
  };
  put("speed_drop_percent", answer.drop, "%");
  put("drop_s", answer.drop_s, "s");
  put("recovery_s", std::min(answer.recovery, longest_s), "s");
  put("speed_end_percent", answer.speed_end, "%");
  put("power_before_W", answer.before, "W");
  put("power_peak_W", answer.peak, "W");
  put("power_dip_W", answer.dip, "W");
  put("power_end_W", answer.end, "W");
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
  const double begin_s = time[step], end_s = time.back();
  if (begin_s < 1.0 || end_s < begin_s + p_.peak_within_s + 1.0) {
    return not_made("a second is needed before the step, and one more than peak_within_s behind it");
  }
  if (!AllNumbers(speed) || !AllNumbers(power)) return not_made("a sample is no number");
  const Answer own = AnswerOf(time, speed, power, step, p_.peak_within_s, p_.band_percent);
  Report(context, "", own, end_s - begin_s);
  ReportVariants(context, step);
  const double middle = 0.5 * (p_.drop_percent[0] + p_.drop_percent[1]), rise = own.end - own.before;
  std::vector<score::Check> checks = {
      score::AtMost(p_.speed + " drop", kName, std::abs(own.drop - middle), p_.drop_percent[1] - middle, "%", p_.origin,
                    fmt::format("{:.3f} % at {:.3f} s behind the step; allowed {:g} to {:g} %", own.drop, own.drop_s,
                                p_.drop_percent[0], p_.drop_percent[1])),
      score::AtMost(p_.speed + " recovery", kName, own.recovery, p_.recovery_s, "s", p_.origin),
      score::AtMost(p_.power + " first rise", kName, 100.0 * std::abs(own.peak - own.end) / std::abs(rise),
                    p_.end_percent, "%", p_.origin,
                    fmt::format("from {:.4g} to {:.4g} at once, {:.4g} in the end", own.before, own.peak, own.end))};
  if (p_.dip_percent > 0.0) {
    const double taken = 100.0 * (std::min(own.peak, own.end) - own.dip) / rise;
    // At least: what is missing of it.
    checks.push_back(score::AtMost(p_.power + " taken back", kName, std::max(0.0, p_.dip_percent - taken), 0.0, "%",
                                   p_.origin,
                                   fmt::format("by {:.2f} % of the rise, {:g} % wanted", taken, p_.dip_percent)));
    if (!(taken >= p_.dip_percent)) checks.back().verdict = score::Verdict::kFail;
  }
  return checks;
}

void LoadStepCheck::ReportVariants(CheckContext& context, std::size_t step) const {
  const Value* variants = context.plan().root.Find("variant");
  for (const std::string& variant : variants != nullptr ? KeysOf(*variants) : std::vector<std::string>()) {
    const std::vector<double>& time = context.samples().time;
    const auto of = [&](const std::string& signal) -> const std::vector<double>* {
      const trace::Signal* found = context.trace != nullptr ? context.trace->Find(signal + "_" + variant) : nullptr;
      return found != nullptr && found->values.size() == time.size() && AllNumbers(found->values) ? &found->values
                                                                                                  : nullptr;
    };
    const std::vector<double>*speed = of(p_.speed), *power = of(p_.power);
    if (speed == nullptr || power == nullptr) continue;
    Report(context, variant + ".", AnswerOf(time, *speed, *power, step, p_.peak_within_s, p_.band_percent),
           time.back() - time[step]);
  }
}

}  // namespace dynoproof
