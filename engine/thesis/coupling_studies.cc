#include "thesis/coupling_studies.h"

#include <fmt/format.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <complex>
#include <limits>
#include <numbers>

#include "experiment/prepare.h"
#include "scenario/find.h"
#include "scenario/load.h"
#include "score/nrmse.h"
#include "sim/solver.h"
#include "thesis/coupling.h"
#include "thesis/studies_runs.h"
#include "thesis/study_parameters.h"

namespace dynoproof {
namespace {

constexpr const char* kShaft = "coupling";

/// The scenario of that id, with the shaft's table replaced (what it joins stays) when `coupling` is given.
Result<std::unique_ptr<Prepared>> Load(const Registry& registry, const std::string& id,
                                       const Value* coupling = nullptr) {
  if (id.empty()) return BadStudy("needs a \"scenario\"");
  Diagnostics diagnostics;
  std::unique_ptr<Prepared> prepared;
  for (const std::string& file : FindScenarios(id, diagnostics)) {
    std::optional<Plan> plan = LoadPlan(file, {}, diagnostics);
    if (!plan) break;
    if (coupling != nullptr) {
      Value* shaft = plan->root.FindPath(std::string("plant.shaft.") + kShaft);
      if (shaft == nullptr || shaft->Find("between") == nullptr) return BadStudy(id + " has no shaft \"coupling\"");
      Value other = *coupling;
      other["between"] = *shaft->Find("between");
      *shaft = std::move(other);
    }
    prepared = Prepare(std::move(*plan), {}, registry, diagnostics);
  }
  if (prepared == nullptr) return BadStudy(diagnostics.Format());
  return prepared;
}

Result<Samples> Run(const Rig& rig) {
  const Result<std::unique_ptr<Solver>> solver = MakeSolver(rig.run.solver, rig);
  return solver.ok() ? Simulate(rig, **solver) : Result<Samples>(solver.failure());
}

Result<Value> ShaftOf(const Registry& registry, const Value& parameters) {
  const auto prepared = Load(registry, parameters.TextOr("scenario"));
  if (!prepared.ok()) return prepared.failure();
  const Value* shaft = (*prepared)->plan.root.FindPath(std::string("plant.shaft.") + kShaft);
  return shaft != nullptr ? Result<Value>(*shaft) : BadStudy("the scenario has no shaft \"coupling\"");
}

}  // namespace

Result<Figure> CouplingSteady(const Registry& registry, const Value& parameters) {
  const Result<Value> shaft = ShaftOf(registry, parameters);
  if (!shaft.ok()) return shaft.failure();
  const Result<double> nu = Number(parameters, "nu");
  if (!nu.ok()) return nu.failure();
  const std::optional<mechanics::DynamicValues> values = SteadyValues(*shaft, *nu);
  if (!values) return BadStudy("the coupling's law has no steady values");
  if (parameters.TextOr("quantity") == "stiffness") return Figure{values->stiffness, "N m/rad"};
  if (parameters.TextOr("quantity") == "damping") return Figure{values->damping, "N m s/rad"};
  return BadStudy("quantity is \"stiffness\" or \"damping\"");
}

Result<Figure> CouplingFrequency(const Registry& registry, const Value& parameters) {
  const auto prepared = Load(registry, parameters.TextOr("scenario"));
  if (!prepared.ok()) return prepared.failure();
  const Result<double> stiffness = Number(parameters, "static_stiffness");
  if (!stiffness.ok()) return stiffness.failure();
  const Block* plant = (*prepared)->rig->FindBlock("plant");
  if (plant == nullptr || plant->component->network() == nullptr) return BadStudy("the plant is no drive line");
  mechanics::Network network = *plant->component->network();
  const std::string shaft = parameters.TextOr("shaft").empty() ? kShaft : parameters.TextOr("shaft");
  if (shaft != kShaft) {  // the coupling somewhere else, a stiff shaft in its place
    const Result<double> rigid = Number(parameters, "rigid_stiffness");
    if (!rigid.ok()) return rigid.failure();
    const int edge = network.FindEdge(kShaft);
    if (edge < 0) return BadStudy("the scenario has no shaft \"coupling\"");
    network.edges[edge].stiffness = *rigid;
  }
  const Result<CouplingChoice> choice = ChooseCouplingMode(network, shaft, *stiffness);
  if (!choice.ok()) return choice.failure();
  return Figure{choice->nu_0, "rad/s"};
}

Result<Figure> CouplingLever(const Registry&, const Value& parameters) {
  const mechanics::OilCouplingGeometry g{.segments = 12,
                                         .width = 0.125,
                                         .length = 0.08,
                                         .inner_radius = 0.11,
                                         .chamber_volume = 3e-4,
                                         .gap_height = 1.6e-3,
                                         .gap_length = 0.03,
                                         .bulk_modulus = 1e6,
                                         .density = 870.0,
                                         .kinematic_viscosity = 50e-6,
                                         .spring = 78e3};
  const double derived = mechanics::FromGeometry(g).k_p;
  const std::string form = parameters.TextOr("form");
  // The printed integrand w (r + y) dy over a length l from `from` on, by Simpson's rule, exact for it.
  const auto integral = [&g](double from) {
    const auto arm = [&g](double y) { return g.inner_radius + y; };
    const double levers = arm(from) + 4.0 * arm(from + 0.5 * g.length) + arm(from + g.length);
    return g.segments * g.width * g.length / 6.0 * levers;
  };
  const double printed = g.segments * g.width * (0.5 * g.length * g.length + 2.0 * g.length * g.inner_radius);
  if (form == "printed") return Figure{printed / integral(0.0), "1"};
  if (form == "limits") return Figure{printed / integral(g.inner_radius), "1"};
  if (form == "integral") return Figure{integral(0.0) / derived, "1"};
  if (form == "power") {  // T_H w = N Dp dV/dt with (4.18)
    return Figure{g.segments * g.side_area() * g.lever() / derived, "1"};
  }
  return BadStudy("form is \"integral\", \"limits\", \"printed\" or \"power\"");
}

Result<Figure> CouplingReynolds(const Registry&, const Value& parameters) {
  const Result<double> velocity = Number(parameters, "velocity"), height = Number(parameters, "gap_height"),
                       width = Number(parameters, "width"), viscosity = Number(parameters, "viscosity");
  for (const Result<double>* number : {&velocity, &height, &width, &viscosity}) {
    if (!number->ok()) return number->failure();
  }
  // Of a segment that displaces so much oil that it flows at this velocity.
  mechanics::OilCouplingGeometry g{.segments = 1,
                                   .width = *width,
                                   .length = 0.08,
                                   .inner_radius = 0.11,
                                   .chamber_volume = 3e-4,
                                   .gap_height = *height,
                                   .gap_length = 0.03,
                                   .bulk_modulus = 1e6,
                                   .density = 870.0,
                                   .kinematic_viscosity = *viscosity,
                                   .spring = 78e3};
  const double rate = *velocity * g.width * g.gap_height / (g.side_area() * g.lever());
  return Figure{CheckValidity(g, 0.0, rate).reynolds, "1"};
}

Result<Figure> CouplingChamberAngle(const Registry& registry, const Value& parameters) {
  const Result<Value> shaft = ShaftOf(registry, parameters);
  if (!shaft.ok()) return shaft.failure();
  const Result<double> beta = Number(parameters, "bulk_modulus"), kappa_w = Number(*shaft, "kappa_w_Pa_per_rad");
  if (!beta.ok()) return beta.failure();
  if (!kappa_w.ok()) return kappa_w.failure();
  // kappa_w = 2 beta A (r + l/2) / V_0, and V_0 / (A (r + l/2)) is the angle over which a chamber reaches.
  return Figure{2.0 * *beta / *kappa_w, "rad"};
}

Result<Figure> CouplingClosedLoop(const Registry& registry, const Value& parameters) {
  const auto prepared = Load(registry, parameters.TextOr("scenario"));
  if (!prepared.ok()) return prepared.failure();
  const Value& root = (*prepared)->plan.root;
  const auto at = [&root](const std::string& path) {
    const Value* value = root.FindPath(path);
    return value != nullptr && value->is_number() ? value->number() : std::nan("");
  };
  mechanics::Network network = *(*prepared)->rig->FindBlock("plant")->component->network();
  const int edge = network.FindEdge(kShaft);
  if (edge < 0) return BadStudy("the scenario has no shaft \"coupling\"");
  const int left = network.edges[edge].from;
  network.edges[edge].stiffness = network.edges[edge].damping = 0.0;
  const std::vector<int> parts = network.Parts();
  double I_a = 0.0, I_b = 0.0;  // what stands on the dynamometer's side, what on the engine's
  for (int i = 0; i < network.size(); ++i) (parts[i] == parts[left] ? I_a : I_b) += network.nodes[i].inertia;
  const std::string shaft = std::string("plant.shaft.") + kShaft + ".";
  const bool oil = root.FindPath(shaft + "k_p_m3") != nullptr;
  const double k = at(shaft + "stiffness_Nm_per_rad"), c = oil ? 0.0 : at(shaft + "damping_Nms_per_rad");
  const double K = oil ? at(shaft + "k_p_m3") * at(shaft + "kappa_w_Pa_per_rad") : 0.0;
  const double kappa = oil ? at(shaft + "kappa_p_per_s") : 1.0;
  const double k_P = at("control.speed.k_P_Nms_per_rad"), k_I = at("control.speed.k_I_Nm_per_rad");
  const Value* lag = root.FindPath("input.T_c.actuator");
  if (lag != nullptr && lag->is_array() && !lag->array().empty()) lag = &lag->array()[0];
  const Value* tau = lag != nullptr ? lag->Find("tau_s") : nullptr;
  if (tau == nullptr || !std::isfinite(k + c + K + kappa + k_P + k_I)) return BadStudy("the scenario has no such loop");
  // States: twist, both speeds, torque of the oil, torque of the machine, integral part of the control.
  Eigen::Matrix<double, 6, 6> A = Eigen::Matrix<double, 6, 6>::Zero();
  A.row(0) << 0.0, 1.0, -1.0, 0.0, 0.0, 0.0;
  A.row(1) << -k / I_a, -c / I_a, c / I_a, -1.0 / I_a, 1.0 / I_a, 0.0;
  A.row(2) << k / I_b, c / I_b, -c / I_b, 1.0 / I_b, 0.0, 0.0;
  A.row(3) << 0.0, K, -K, -kappa, 0.0, 0.0;
  A.row(4) << 0.0, -k_P, 0.0, 0.0, -1.0, 1.0;
  A.row(4) /= tau->number();
  A(5, 1) = -k_I;
  std::complex<double> slowest = std::numeric_limits<double>::infinity();
  for (const std::complex<double>& s : A.eigenvalues()) {
    if (s.imag() > 0.0 && std::abs(s) < std::abs(slowest)) slowest = s;
  }
  const double loop_Hz = std::abs(slowest) / (2.0 * std::numbers::pi);
  if (parameters.TextOr("figure").empty()) return Figure{loop_Hz, "Hz"};
  const Result<Figure> peak = ScenarioFigure(registry, parameters);
  if (!peak.ok()) return peak;
  return Figure{std::abs(peak->value - loop_Hz) / (-slowest.real() / (2.0 * std::numbers::pi)), "1"};
}

Result<Figure> CouplingRivals(const Registry& registry, const Value& parameters) {
  const std::string signal = parameters.TextOr("signal");
  const Value *first = parameters.Find("first"), *second = parameters.Find("second"),
              *during = parameters.Find("during_s");
  if (first == nullptr || second == nullptr) return BadStudy("needs the couplings \"first\" and \"second\"");
  const bool stretch = during != nullptr && during->is_array() && during->array().size() == 2 &&
                       during->array()[0].is_number() && during->array()[1].is_number();
  std::vector<double> courses[3];
  int next = 0;
  for (const Value* coupling : {static_cast<const Value*>(nullptr), first, second}) {
    const auto prepared = Load(registry, parameters.TextOr("scenario"), coupling);
    if (!prepared.ok()) return prepared.failure();
    const Result<Samples> samples = Run(*(*prepared)->rig);
    if (!samples.ok()) return samples.failure();
    const score::Series series = SeriesOf(*samples, *(*prepared)->rig, signal);
    if (series.values.empty()) return BadStudy(fmt::format("there is no signal \"{}\"", signal));
    for (std::size_t i = 0; i < series.values.size(); ++i) {
      const double t = series.time_s[i];
      if (stretch && (t < during->array()[0].number() || t > during->array()[1].number())) continue;
      courses[next].push_back(series.values[i]);
    }
    ++next;
  }
  double error[2] = {0.0, 0.0};
  for (int which = 0; which < 2; ++which) {
    for (std::size_t i = 0; i < courses[0].size(); ++i) {
      error[which] += std::pow(courses[1 + which].at(i) - courses[0][i], 2);
    }
  }
  if (!(error[1] > 0.0)) return BadStudy("the second coupling does not differ from the scenario's");
  return Figure{std::sqrt(error[0] / error[1]), "1"};  // both divided by the same spread
}

}  // namespace dynoproof
