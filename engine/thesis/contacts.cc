#include "thesis/contacts.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/bad_input.h"
#include "experiment/checks.h"
#include "linear/network.h"

namespace dynoproof {
namespace {

Failure BadContacts(std::string why) { return BadInput(std::move(why), "contacts"); }

/// The part of the line that hangs on `node` when the shaft between is taken out.
std::vector<bool> PartOf(const mechanics::Network& network, int removed, int node) {
  std::vector<bool> inside(network.nodes.size());
  inside[node] = true;
  for (bool changed = true; changed;) {
    changed = false;
    for (int e = 0; e < static_cast<int>(network.edges.size()); ++e) {
      const mechanics::Edge& edge = network.edges[e];
      if (e == removed || edge.to == mechanics::kGround || inside[edge.from] == inside[edge.to]) continue;
      inside[edge.from] = inside[edge.to] = changed = true;
    }
  }
  return inside;
}

/// When a cubic through value and slope at both ends of a step leaves +-`level` at `side`, as a fraction of the step.
double Crossing(double d0, double w0, double d1, double w1, double h, double level, int side) {
  const auto beyond = [&](double s) {
    const double r = 1.0 - s;
    const double d = r * r * (1.0 + 2.0 * s) * d0 + s * s * (3.0 - 2.0 * s) * d1 + s * r * h * (r * w0 - s * w1);
    return side * d - level;
  };
  double low = 0.0, high = 1.0;
  for (int i = 0; i < 40; ++i) {
    const double middle = 0.5 * (low + high);
    (beyond(middle) > 0.0 ? high : low) = middle;
  }
  return high;
}

/// Sides that part for less than this bounce within one impact: the members on both sides ring at 450 Hz and more.
constexpr double kBounce_s = 1e-3;

struct Signals {
  const std::vector<double>&time, &twist, &rate, &torque;
  std::vector<double> before, behind;  // mean speeds of the two parts
  double alpha;
};

std::vector<Impact> FindImpacts(const Signals& s) {
  std::vector<Impact> impacts;
  const double h = s.time[1] - s.time[0];
  const auto side_of = [&s](std::size_t k) { return s.twist[k] > s.alpha ? 1 : s.twist[k] < -s.alpha ? -1 : 0; };
  int last = side_of(0);
  double left_at = last == 0 ? -1.0 : 0.0, left_speed = 0.0;  // when the sides parted last
  for (std::size_t k = 1; k + 1 < s.time.size(); ++k) {
    const int now = side_of(k), next = side_of(k + 1);
    if (!impacts.empty()) {
      Impact& impact = impacts.back();
      impact.peak_torque_Nm = std::max(impact.peak_torque_Nm, std::abs(s.torque[k]));
      const bool away = now == 0 && left_at > impact.time_s && s.time[k] - left_at > kBounce_s;
      if (away && impact.rebound_rad_per_s == 0.0) impact.rebound_rad_per_s = left_speed;
    }
    if (now != 0 && next == 0) {
      left_at = s.time[k + 1];
      left_speed = s.behind[k + 1];
    }
    if (next == 0 || next == now) continue;
    const double at = Crossing(s.twist[k], s.rate[k], s.twist[k + 1], s.rate[k + 1], h, s.alpha, next);
    const double time_s = s.time[k] + at * h;
    if (next == last && time_s - left_at < kBounce_s) continue;
    const auto ahead = [&](const std::vector<double>& v) { return v[k] + at * (v[k] - v[k - 1]); };
    impacts.push_back({time_s, next, std::abs(ahead(s.before) - ahead(s.behind)), ahead(s.behind)});
    last = next;
  }
  return impacts;
}

}  // namespace

Result<ContactCourse> FollowContacts(const Plan& plan, const std::string& shaft, const std::string& solver,
                                     const Registry& registry, const Records& records) {
  const Value* gap = plan.root.FindPath("plant.shaft." + shaft + ".half_gap_rad");
  if (gap == nullptr || !gap->is_number()) return BadContacts(fmt::format("shaft \"{}\" has no half_gap_rad", shaft));
  Plan extended = plan;
  extended.root.Erase("variant");
  const auto observe = [&extended](const std::string& name, const std::string& of) {
    extended.root["output"]["contact_" + name] = Value{{"of", of}};
  };
  for (const char* quantity : {"twist", "rate", "torque"}) {
    observe(quantity, fmt::format("plant.{}.{}", shaft, quantity));
  }
  const Value* inertias = plan.root.FindPath("plant.inertia");
  if (inertias == nullptr) return BadContacts("the plant has no inertia");
  for (const std::string& name : KeysOf(*inertias)) observe(name, fmt::format("plant.{}.speed", name));
  Diagnostics diagnostics;
  const std::unique_ptr<Rig> rig = Rig::Build(extended, registry, records, diagnostics);
  if (rig == nullptr) return BadContacts(diagnostics.Format());
  const mechanics::Network* network = rig->FindBlock("plant")->component->network();
  const int edge = network != nullptr ? network->FindEdge(shaft) : -1;
  if (edge < 0) return BadContacts(fmt::format("the plant is no drive line with a shaft \"{}\"", shaft));
  const std::vector<bool> behind = PartOf(*network, edge, network->edges[edge].to);
  if (behind[network->edges[edge].from]) return BadContacts(fmt::format("shaft \"{}\" does not part the line", shaft));

  Result<std::unique_ptr<Solver>> made = MakeSolver(solver, *rig);
  if (!made.ok()) return made.failure();
  Result<Samples> samples = Simulate(*rig, **made);
  if (!samples.ok()) return samples.failure();
  ContactCourse course{std::move(*samples), {}};
  const auto signal = [&](const std::string& name) -> const std::vector<double>& {
    return course.samples.outputs[FindOutput(*rig, "contact_" + name)];
  };
  Signals signals{course.samples.time, signal("twist"), signal("rate"), signal("torque"), {}, {}, gap->number()};
  const std::size_t rows = course.samples.time.size();
  if (rows < 3) return BadContacts("the run is too short");
  double sum[2] = {0.0, 0.0};
  signals.before.assign(rows, 0.0);
  signals.behind.assign(rows, 0.0);
  for (std::size_t i = 0; i < network->nodes.size(); ++i) {
    const mechanics::Node& node = network->nodes[i];
    if (inertias->Find(node.name) == nullptr) return BadContacts("a soft rotor has no single speed");
    const std::vector<double>& speed = signal(node.name);
    std::vector<double>& mean = behind[i] ? signals.behind : signals.before;
    sum[behind[i]] += node.inertia;
    for (std::size_t k = 0; k < rows; ++k) mean[k] += node.inertia * speed[k];
  }
  for (double& value : signals.before) value /= sum[0];
  for (double& value : signals.behind) value /= sum[1];
  course.impacts = FindImpacts(signals);
  return course;
}

}  // namespace dynoproof
