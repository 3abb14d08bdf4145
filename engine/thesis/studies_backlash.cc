// Studies of chapter 3: what a claim says of the motion through a gap, computed.
#include "thesis/studies_backlash.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "experiment/prepare.h"
#include "scenario/find.h"
#include "scenario/load.h"
#include "thesis/contacts.h"
#include "thesis/study_parameters.h"

namespace dynoproof {
namespace {

/// The claim's scenario, with its law (variant) and c_f laid over it.
Result<Plan> PlanOf(const Value& parameters, const std::string& law) {
  Diagnostics diagnostics;
  const std::vector<std::string> files = FindScenarios(parameters.TextOr("scenario"), diagnostics);
  std::optional<Plan> plan = files.size() == 1 ? LoadPlan(files[0], {}, diagnostics) : std::nullopt;
  if (!plan) return BadStudy(diagnostics.Format());
  if (const Value* variant = plan->root.FindPath("variant." + law)) {
    const Value copy = *variant;
    MergeInto(plan->root, copy);
  } else if (!law.empty()) {
    plan->root["plant"]["shaft"]["backlash"]["law"] = Value(law);
  }
  plan->root.Erase("variant");
  if (parameters.Find("c_f") != nullptr) {
    plan->root["plant"]["shaft"]["backlash"]["contact_free_damping_Nms_per_rad"] = *parameters.Find("c_f");
  }
  return *plan;
}

Result<ContactCourse> CourseOf(const Registry& registry, const Value& parameters, const std::string& law) {
  Result<Plan> plan = PlanOf(parameters, law);
  if (!plan.ok()) return plan.failure();
  Result<ContactCourse> course =
      FollowContacts(*plan, "backlash", parameters.TextOr("solver", "reference"), registry, {});
  if (!course.ok()) return course.failure();
  const double from_s = parameters.NumberOr("from_s", 0.0);
  std::erase_if(course->impacts, [from_s](const Impact& impact) { return impact.time_s <= from_s; });
  if (course->impacts.empty()) return BadStudy("no impact");
  return course;
}

}  // namespace

Result<Figure> BacklashImpact(const Registry& registry, const Value& parameters) {
  const Result<ContactCourse> course = CourseOf(registry, parameters, parameters.TextOr("law"));
  if (!course.ok()) return course.failure();
  const Impact& impact = course->impacts.front();
  const std::string figure = parameters.TextOr("figure");
  if (figure == "time_ms") return Figure{1e3 * (impact.time_s - parameters.NumberOr("from_s", 0.0)), "ms"};
  if (figure == "speed") return Figure{std::abs(impact.speed_rad_per_s), "rad/s"};
  if (figure == "peak") return Figure{impact.peak_torque_Nm, "N m"};
  if (figure == "rebound") return Figure{-std::abs(impact.rebound_rad_per_s), "rad/s"};
  return BadStudy("needs a \"figure\": time_ms, speed, peak or rebound");
}

Result<Figure> BacklashRigidMass(const Registry&, const Value& parameters) {
  // J dw/dt = T - c_f w from rest over the way 2 alpha: with tau = J/c_f the way is (T/c_f)(t - tau (1 - exp(-t/tau))).
  const double J = parameters.NumberOr("inertia", 0.0), T = parameters.NumberOr("torque", 0.0),
               c_f = parameters.NumberOr("c_f", 0.0), way = 2.0 * parameters.NumberOr("half_gap_rad", 0.0);
  if (!(J > 0.0 && T > 0.0 && way > 0.0 && c_f >= 0.0)) return BadStudy("needs inertia, torque, half_gap_rad, c_f");
  double low = 0.0, high = 1.0;
  const auto angle = [&](double t) {
    return c_f == 0.0 ? 0.5 * T / J * t * t : T / c_f * (t + J / c_f * std::expm1(-c_f / J * t));
  };
  while (angle(high) < way) high *= 2.0;
  for (int i = 0; i < 100; ++i) (angle(0.5 * (low + high)) < way ? low : high) = 0.5 * (low + high);
  if (parameters.TextOr("figure") == "time_ms") return Figure{1e3 * high, "ms"};
  return Figure{c_f == 0.0 ? T / J * high : -T / c_f * std::expm1(-c_f / J * high), "rad/s"};
}

Result<Figure> BacklashLaws(const Registry& registry, const Value& parameters) {
  const Result<ContactCourse> one = CourseOf(registry, parameters, parameters.TextOr("law")),
                              other = CourseOf(registry, parameters, parameters.TextOr("other"));
  if (!one.ok()) return one.failure();
  if (!other.ok()) return other.failure();
  const auto number = static_cast<std::size_t>(parameters.NumberOr("until_impact", 2.0));
  if (number < 1 || one->impacts.size() < number) return BadStudy("too few impacts");
  // The signal of the scenario, over what it spreads from from_s to that impact.
  const Result<Plan> plan = PlanOf(parameters, "");
  if (!plan.ok()) return plan.failure();
  const std::string signal = parameters.TextOr("signal", "omega_1");
  const std::vector<std::string> names = KeysOf(*plan->root.Find("output"));
  const auto output = static_cast<std::size_t>(std::find(names.begin(), names.end(), signal) - names.begin());
  if (output == names.size()) return BadStudy("the scenario has no output " + signal);
  const double from_s = parameters.NumberOr("from_s", 0.0), to_s = one->impacts[number - 1].time_s;
  double error = 0.0, mean = 0.0, square = 0.0, count = 0.0;
  for (std::size_t k = 0; k < one->samples.time.size(); ++k) {
    if (one->samples.time[k] < from_s || one->samples.time[k] > to_s) continue;
    const double a = one->samples.outputs[output][k], b = other->samples.outputs[output][k];
    error += (a - b) * (a - b);
    mean += a;
    square += a * a;
    count += 1.0;
  }
  mean /= count;
  return Figure{std::sqrt(error / count / (square / count - mean * mean)), "1"};
}

Result<Figure> RotorInThirds(const Registry&, const Value& parameters) {
  const double third = parameters.NumberOr("inertia", 0.0) / 3.0, k = parameters.NumberOr("stiffness", 0.0);
  if (!(third > 0.0 && k > 0.0)) return BadStudy("needs inertia and stiffness");
  // Equal thirds on two equal springs: outer ones against each other, sqrt(k/m), then sqrt(3 k/m).
  return Figure{std::sqrt(k / third) / (2.0 * std::numbers::pi), "Hz"};
}

}  // namespace dynoproof
