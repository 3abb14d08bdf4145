#include "thesis/check_filters.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <span>

#include "thesis/machine_scenario.h"

namespace dynoproof {
namespace {

using Modes = Result<std::vector<FilteredLoopMode>>;

/// A run's filters over time, with the loop that they stand in.
class HeldCourse {
 public:
  HeldCourse(CheckContext& context, const MachineLoop& loop, const std::vector<std::string>& notches,
             const std::string& gain)
      : loop_(loop),
        gain_(context.Find(gain)->series.values),
        radius_(context.plan().root.NumberOr("control.core.radius", control10k::SuppressionConfig{}.radius)),
        period_s_(context.rig().run.period_s) {
    for (const std::string& notch : notches) frequencies_.push_back(context.Find(notch)->series.values);
  }

  std::size_t samples() const { return gain_.size(); }
  double k_V(std::size_t sample) const { return gain_[sample]; }
  double radius() const { return radius_; }
  std::vector<double> At(std::size_t sample) const {
    std::vector<double> now;
    for (const std::span<const double> one : frequencies_) now.push_back(one[sample]);
    return now;
  }
  /// The modes of the loop with the filters and the gain of a sample.
  Modes ModesAt(std::size_t sample) const {
    std::vector<control10k::NotchCoefficients> filters;
    for (const double f_Hz : At(sample)) {
      control10k::NotchCoefficients c;
      if (!control10k::DesignNotch(2.0 * std::numbers::pi * f_Hz * period_s_, radius_, c))
        return Failure{fmt::format("no filter stands at {} Hz", f_Hz), "filters_hold", {}, 3};
      filters.push_back(c);
    }
    return loop_.Modes(k_V(sample), filters);
  }

 private:
  const MachineLoop& loop_;
  std::span<const double> gain_;
  std::vector<std::span<const double>> frequencies_;
  double radius_, period_s_;
};

std::vector<double> Growing(const std::vector<FilteredLoopMode>& modes, double growth_per_s) {
  std::vector<double> growing;
  for (const FilteredLoopMode& mode : modes) {
    if (mode.growth_per_s > growth_per_s) growing.push_back(mode.frequency_hz);
  }
  return growing;
}

bool Near(const std::vector<double>& modes, double f_Hz, double near_Hz) {
  return std::ranges::any_of(modes, [=](double mode) { return std::abs(mode - f_Hz) < near_Hz; });
}

/// Whether some setting of so many filters holds the loop: searched from where they stand and from the growing modes.
Result<bool> CanBeHeld(const MachineLoop& loop, double k_V, double radius, const std::vector<double>& standing,
                       std::vector<double> growing) {
  // A filter without a mode of its own takes what its neighbour moves away: 5 Hz below.
  while (growing.size() < standing.size()) growing.push_back(growing.back() - 5.0);
  growing.resize(standing.size());
  for (const std::vector<double>& start : {standing, growing}) {
    const Result<SteadiestFilters> found = FindSteadiestFilters(loop, k_V, start, radius);
    if (!found.ok()) return found.failure();
    if (found->growth_per_s < 0.0) return true;
  }
  return false;
}

/// What the placements of a run are worth.
struct Placements {
  int placed = 0, wrong = 0, growing = 0, found = 0;
  std::string first_wrong;
};
Result<Placements> Judge(const HeldCourse& course, double near_Hz, double growth_per_s) {
  Placements result;
  const Modes idle = course.ModesAt(1);  // the first sample is taken before the control has ticked
  if (!idle.ok()) return idle.failure();
  const std::vector<double> growing = Growing(*idle, growth_per_s);
  std::vector<bool> found(growing.size(), false);
  for (std::size_t n = 2; n < course.samples(); ++n) {
    const std::vector<double> before = course.At(n - 1), now = course.At(n);
    if (now == before) continue;
    const Modes modes = course.ModesAt(n - 1);
    if (!modes.ok()) return modes.failure();
    for (std::size_t i = 0; i < now.size(); ++i) {
      if (now[i] == before[i]) continue;
      ++result.placed;
      // With the others in place a mode may already fall that grew before: what is heard of it is the loop's own still.
      const bool right = Near(Growing(*modes, growth_per_s), now[i], near_Hz) || Near(growing, now[i], near_Hz);
      if (!right && ++result.wrong == 1)
        result.first_wrong = fmt::format("a filter went to {:.2f} Hz in period {}, where nothing grew", now[i], n);
      for (std::size_t k = 0; k < growing.size(); ++k) found[k] = found[k] || Near({growing[k]}, now[i], near_Hz);
    }
  }
  result.growing = static_cast<int>(growing.size());
  result.found = static_cast<int>(std::ranges::count(found, true));
  return result;
}

}  // namespace

std::vector<score::Check> FiltersHoldCheck::Run(CheckContext& context) const {
  const auto broken = [this](const Failure& failure) {
    return std::vector{FailedCheck(kName, kName, p_.growth_per_s, "1/s", p_.origin, failure.ToString())};
  };
  const Result<MachineLoop> loop = MachineLoopOf(context.plan(), context.rig(), kHighest_Hz);
  if (!loop.ok()) return broken(loop.failure());
  const HeldCourse course(context, *loop, p_.notches, p_.gain);
  if (course.samples() < 3) return broken(Failure{"the run has no course", "filters_hold", {}, 3});
  const Result<Placements> placements = Judge(course, p_.near_Hz, p_.growth_per_s);
  if (!placements.ok()) return broken(placements.failure());
  const std::size_t last = course.samples() - 1;
  const Modes left = course.ModesAt(last);
  if (!left.ok()) return broken(left.failure());
  const FilteredLoopMode& fastest = left->front();
  const std::vector<double> growing = Growing(*left, p_.growth_per_s);
  bool beyond = false;
  if (!growing.empty()) {
    const Result<bool> held = CanBeHeld(*loop, course.k_V(last), course.radius(), course.At(last), growing);
    if (!held.ok()) return broken(held.failure());
    beyond = !*held;
  }
  const auto note = [&context](const char* name, double value, const char* unit = "1") {
    context.figures[name] = {value, unit};
  };
  note("growing", placements->growing);
  note("found", placements->found);
  note("placed", placements->placed);
  note("false_placements", placements->wrong);
  note("growth_at_end", fastest.growth_per_s, "1/s");
  note("unstable_at_end", growing.empty() ? 0.0 : 1.0);
  note("beyond_filters", beyond ? 1.0 : 0.0);
  return {score::AtMost("growth with the filters of the end", kName, fastest.growth_per_s, p_.growth_per_s, "1/s",
                        p_.origin, fmt::format("the mode at {:.2f} Hz", fastest.frequency_hz)),
          score::AtMost("filters where nothing grew", kName, placements->wrong, 0.0, "1", p_.origin,
                        placements->first_wrong)};
}

void FiltersHoldCheck::Applies(const Plan& plan, const Rig& rig, Diagnostics& diagnostics) const {
  const Result<MachineLoop> loop = MachineLoopOf(plan, rig, kHighest_Hz);
  if (loop.ok()) return;
  diagnostics.Error(stated_at, "cannot judge the filters: " + loop.failure().message,
                    "check what they do to the run instead: kind = \"placements\"");
}

}  // namespace dynoproof
