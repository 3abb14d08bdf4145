#include "thesis/check_contacts.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "sim/solver.h"
#include "thesis/contacts.h"

namespace dynoproof {
namespace {

std::string Order(const std::vector<Impact>& impacts, int most) {
  std::string order;
  for (const Impact& impact : impacts) {
    if (static_cast<int>(order.size()) < most) order += impact.side > 0 ? '+' : '-';
  }
  return order;
}

}  // namespace

std::vector<score::Check> ContactsCheck::Run(CheckContext& context) const {
  std::vector<std::pair<std::string, Plan>> plans;
  const Value* variants = context.plan().root.Find("variant");
  for (const std::string& name : variants != nullptr ? KeysOf(*variants) : std::vector<std::string>()) {
    Plan plan = context.plan();
    MergeInto(plan.root, *variants->Find(name));
    plans.emplace_back(name, std::move(plan));
  }
  if (plans.empty()) {
    const Value* law = context.plan().root.FindPath("plant.shaft." + p_.shaft + ".law");
    plans.emplace_back(law != nullptr && law->is_string() ? law->string() : "spring_damper", context.plan());
  }
  const int output = FindOutput(context.rig(), p_.signal);
  std::vector<score::Check> checks;
  std::map<std::string, ContactCourse> courses;
  std::map<std::string, std::pair<double, double>> impact_times;
  for (auto& variant : plans) {
    const std::string& name = variant.first;
    Plan& plan = variant.second;
    const auto follow = [&](const std::string& solver) {
      Result<ContactCourse> course = FollowContacts(plan, p_.shaft, solver, *context.registry, *context.records);
      if (course.ok()) {
        std::erase_if(course->impacts, [this](const Impact& impact) { return impact.time_s <= p_.from_s; });
      }
      return course;
    };
    Result<ContactCourse> exact = follow("reference");
    const Result<ContactCourse> real = follow("realtime");
    const int substeps = SubstepsOf(plan);
    SetSubsteps(plan, 2 * substeps);
    const Result<ContactCourse> halved = follow("realtime");
    const auto fail = [&](std::string why) {
      checks.push_back(FailedCheck(kName, name + " impacts", p_.impact_ms, "ms", p_.origin, std::move(why)));
    };
    if (!exact.ok() || !real.ok() || !halved.ok()) {
      fail((!exact.ok() ? exact : !real.ok() ? real : halved).failure().ToString());
      continue;
    }
    if (exact->impacts.size() < 2 || real->impacts.size() < 2 || halved->impacts.size() < 2) {
      fail(fmt::format("{} impacts with reference, {} with realtime, {} with halved steps: two are needed",
                       exact->impacts.size(), real->impacts.size(), halved->impacts.size()));
      continue;
    }
    const double second = exact->impacts[1].time_s;
    for (int i = 0; i < 2; ++i) {
      const Impact &want = exact->impacts[i], &seen = real->impacts[i];
      const std::string prefix = fmt::format("{}.impact_{}_", name, i + 1);
      context.figures[prefix + "ms"] = {1e3 * (want.time_s - p_.from_s), "ms"};
      context.figures[prefix + "rad_per_s"] = {want.approach_rad_per_s, "rad/s"};
      context.figures[prefix + "peak_Nm"] = {want.peak_torque_Nm, "N m"};
      checks.push_back(
          score::AtMost(fmt::format("{} impact {}", name, i + 1), kName, 1e3 * std::abs(seen.time_s - want.time_s),
                        p_.impact_ms, "ms", p_.origin,
                        fmt::format("reference {:.4f} ms, realtime {:.4f} ms after {} s",
                                    1e3 * (want.time_s - p_.from_s), 1e3 * (seen.time_s - p_.from_s), p_.from_s)));
    }
    checks.push_back(score::AtMost(fmt::format("{} {} up to impact 2", name, p_.signal), kName,
                                   RelativeDistance(exact->samples, real->samples, output, p_.from_s, second), p_.nrmse,
                                   "1", p_.origin));
    const double by_halving = RelativeDistance(halved->samples, real->samples, output, p_.from_s, second);
    context.figures[name + ".step_halving"] = {by_halving, "1"};
    checks.push_back(score::AtMost(fmt::format("{} {} against halved steps", name, p_.signal), kName, by_halving,
                                   p_.nrmse, "1", p_.origin));
    const std::string want = Order(exact->impacts, p_.order_of), seen = Order(real->impacts, p_.order_of);
    checks.push_back(score::AtMost(name + " order of impacts", kName, want == seen ? 0.0 : 1.0, 0.0, "1",
                                   "the same sides in the same order", fmt::format("{} and {}", want, seen)));
    impact_times[name] = {exact->impacts[0].time_s, second};
    courses.emplace(name, std::move(*exact));
  }
  const auto compare = [&](const std::vector<std::string>& names, bool alike) {
    for (std::size_t i = 1; i < names.size(); ++i) {
      const std::string what = fmt::format("{} {} {}", names[i], alike ? "agrees with" : "differs from", names[0]);
      const double limit = alike ? p_.alike_nrmse : p_.unlike_nrmse;
      if (!courses.contains(names[0]) || !courses.contains(names[i])) {
        checks.push_back(
            FailedCheck(kName, what, limit, "1", p_.origin, "there is no such variant, or it has no impacts"));
        continue;
      }
      const auto& [first, second] = impact_times[names[0]];
      const double distance = RelativeDistance(courses.at(names[0]).samples, courses.at(names[i]).samples, output,
                                               p_.from_s, alike ? second : first);
      context.figures[fmt::format("{}.{}_{}", names[i], alike ? "agrees_with" : "differs_from", names[0])] = {distance,
                                                                                                              "1"};
      checks.push_back(alike ? score::AtMost(what, kName, distance, limit, "1", p_.origin)
                             : score::AtLeast(what, kName, distance, limit, "1", p_.origin, "inside the gap"));
    }
  };
  compare(p_.alike, true);
  compare(p_.unlike, false);
  return checks;
}

std::vector<score::Check> DivergenceCheck::Run(CheckContext& context) const {
  std::vector<score::Check> checks;
  const int output = FindOutput(context.rig(), p_.signal);
  const Value* variants = context.plan().root.Find("variant");
  std::vector<std::string> names = variants != nullptr ? KeysOf(*variants) : std::vector<std::string>();
  if (names.empty()) names.emplace_back();
  for (const std::string& variant : names) {
    Plan plan = context.plan();
    plan.root.Erase("variant");
    if (!variant.empty()) MergeInto(plan.root, *variants->Find(variant));
    const std::string name = fmt::format("{}divergence of {}", variant.empty() ? "" : variant + " ", p_.signal);
    std::vector<Samples> runs;
    std::string fault;
    for (const double change : {0.0, p_.delta}) {
      Plan changed = plan;
      Value* value = changed.root.FindPath(p_.path);
      if (value == nullptr || !value->is_number()) {
        fault = fmt::format("there is no number at \"{}\"", p_.path);
        break;
      }
      *value = Value(value->number() * (1.0 + change));
      Diagnostics diagnostics;
      const std::unique_ptr<Rig> rig = Rig::Build(changed, *context.registry, *context.records, diagnostics);
      if (rig == nullptr) {
        fault = diagnostics.Format();
        break;
      }
      Result<std::unique_ptr<Solver>> solver = MakeSolver(context.solver(), *rig);
      Result<Samples> samples = solver.ok() ? Simulate(*rig, **solver) : Result<Samples>(solver.failure());
      if (!samples.ok()) {
        fault = samples.failure().ToString();
        break;
      }
      runs.push_back(std::move(*samples));
    }
    if (runs.size() < 2) {
      checks.push_back(FailedCheck(kName, name, p_.at_most_per_s, "1/s", p_.origin, fault));
      continue;
    }
    // The slope of the logarithm of the largest distance in each hundredth of the span.
    constexpr int kBins = 100;
    std::vector<double> most(kBins, 0.0);
    double last = 0.0, peak = 0.0, largest = 0.0;
    for (std::size_t k = 0; k < runs[0].time.size(); ++k) {
      const double share = (runs[0].time[k] - p_.from_s) / (p_.to_s - p_.from_s);
      const double distance = std::abs(runs[0].outputs[output][k] - runs[1].outputs[output][k]);
      peak = std::max(peak, std::abs(runs[0].outputs[output][k]));
      if (share < 0.0 || share >= 1.0) continue;
      double& bin = most[static_cast<int>(share * kBins)];
      bin = std::max(bin, distance);
      last = bin;
      largest = std::max(largest, distance);
    }
    double n = 0.0, sx = 0.0, sy = 0.0, sxx = 0.0, sxy = 0.0;
    for (int i = 0; i < kBins; ++i) {
      if (most[i] <= 0.0) continue;
      const double x = (i + 0.5) / kBins * (p_.to_s - p_.from_s), y = std::log(most[i]);
      n += 1.0;
      sx += x;
      sy += y;
      sxx += x * x;
      sxy += x * y;
    }
    const double rate = n > 2.0 ? (n * sxy - sx * sy) / (n * sxx - sx * sx) : std::numeric_limits<double>::quiet_NaN();
    const std::string prefix = variant.empty() ? "" : variant + ".";
    context.figures[prefix + "divergence_per_s"] = {rate, "1/s"};
    context.figures[prefix + "divergence_at_end"] = {last / peak, "1"};
    context.figures[prefix + "divergence_largest"] = {largest / peak, "1"};
    checks.push_back(
        score::AtMost(name, kName, rate, p_.at_most_per_s, "1/s", p_.origin,
                      fmt::format("a change of {:g} in {} has grown to {:.2g} of the signal's peak at {} s", p_.delta,
                                  p_.path, last / peak, p_.to_s)));
  }
  return checks;
}

}  // namespace dynoproof
