#include <fmt/format.h>

#include <array>
#include <boost/numeric/odeint/integrate/integrate_adaptive.hpp>
#include <boost/numeric/odeint/stepper/bulirsch_stoer.hpp>
#include <cmath>
#include <functional>
#include <numbers>

#include "oracles/oracle.h"

namespace dynoproof::oracles {
namespace {

using Real = long double;
using State = std::array<Real, 3>;
using Held = std::map<std::string, Real>;  // by port of the plant

constexpr Real kBar = 1e5L;  // pressures are integrated in bar, positions in mm, so that one tolerance suits all

/// A pressure plant, written down once more from the scenario's tables.
struct Plant {
  std::function<State(const Held&)> start;
  std::function<void(const Held&, const State&, State&)> rates;
  std::map<std::string, std::function<Real(const Held&, const State&)>> outputs;  // by port
};

Real Number(const Value& table, const char* path, Real fallback) {
  const Value* value = table.FindPath(path);
  return value != nullptr && value->is_number() ? static_cast<Real>(value->number()) : fallback;
}

std::string Text(const Value& table, const char* path, const char* fallback) {
  const Value* value = table.FindPath(path);
  return value != nullptr && value->is_string() ? value->string() : fallback;
}

/// (6.4) in both directions, by the pressure ratio as it is printed.
Real Through(Real area, Real R_theta, Real from, Real to, Real kappa) {
  if (from < to) return -Through(area, R_theta, to, from, kappa);
  if (!(from > 0.0L) || from == to) return 0.0L;
  const Real x = std::max(to, 0.0L) / from;  // 1/xi
  Real psi;
  if (kappa == 0.0L) {
    psi = x <= 0.5L ? std::sqrt(0.5L) : std::sqrt(2.0L * x * (1.0L - x));
  } else {
    const Real choked = std::pow(2.0L / (kappa + 1.0L), kappa / (kappa - 1.0L)), y = std::max(x, choked);
    psi = std::sqrt(2.0L * kappa / (kappa - 1.0L) * (std::pow(y, 2.0L / kappa) - std::pow(y, (kappa + 1.0L) / kappa)));
  }
  return area * from / std::sqrt(R_theta) * psi;
}

std::string ReadChargeAir(const Value& plant, Plant& made) {
  const Real R_theta = Number(plant, "R_J_per_kg_K", 287.05L) * Number(plant, "theta_K", 320.0L);
  const Real ambient = Number(plant, "ambient_pressure_Pa", 101300.0L);
  const Real kappa = Text(plant, "flow_function", "approximate") == "isentropic" ? Number(plant, "kappa", 1.4L) : 0.0L;
  struct Flap {
    Real offset, span, factor;
    Real operator()(Real u) const {
      const Real inside = std::min(100.0L, std::max(0.0L, u));
      return factor * (offset + span * (1.0L - std::cos(std::numbers::pi_v<Real> * inside / 200.0L)));
    }
  };
  std::array<Flap, 2> flap;
  for (int i = 0; i < 2; ++i) {
    const Value* table = plant.FindPath(i == 0 ? "flap.1" : "flap.2");
    if (table == nullptr || Text(*table, "law", "cosine") != "cosine") return "a flap's area is a table";
    flap[i] = {Number(*table, "area_offset_m2", 1e-5L), Number(*table, "area_span_m2", 0.0L),
               Number(*table, "area_factor", 1.0L)};
  }
  const Real V_1 = Number(plant, "volume.V_1.volume_m3", 1.0L), V_2 = Number(plant, "volume.V_2.volume_m3", 1.0L);
  const Real leak_1 = Number(plant, "volume.V_1.leakage_area_m2", 0.0L);
  const Real leak_2 = Number(plant, "volume.V_2.leakage_area_m2", 0.0L);
  const State first = {Number(plant, "volume.V_1.start_pressure_Pa", 101300.0L) / kBar,
                       Number(plant, "volume.V_2.start_pressure_Pa", 101300.0L) / kBar, 0.0L};
  made.start = [first](const Held&) { return first; };
  const auto flows = [=](const Held& u, const State& s) {
    return std::pair(Through(flap[0](u.at("u_1")), R_theta, kBar * s[1], kBar * s[0], kappa),
                     Through(flap[1](u.at("u_2")), R_theta, kBar * s[1], ambient, kappa));
  };
  made.rates = [=](const Held& u, const State& s, State& rates) {
    const auto [q_1, q_2] = flows(u, s);
    rates[0] = R_theta / V_1 * (q_1 - u.at("q_e") - Through(leak_1, R_theta, kBar * s[0], ambient, kappa)) / kBar;
    rates[1] = R_theta / V_2 * (u.at("q_c") - q_1 - q_2 - Through(leak_2, R_theta, kBar * s[1], ambient, kappa)) / kBar;
    rates[2] = 0.0L;
  };
  made.outputs = {{"p_ch", [](const Held&, const State& s) { return kBar * s[0]; }},
                  {"p_s", [](const Held&, const State& s) { return kBar * s[1]; }},
                  {"q_1", [flows](const Held& u, const State& s) { return flows(u, s).first; }},
                  {"q_2", [flows](const Held& u, const State& s) { return flows(u, s).second; }}};
  return "";
}

std::string ReadFuelGas(const Value& plant, Plant& made) {
  const Real R_theta = Number(plant, "R_J_per_kg_K", 518.0L) * Number(plant, "theta_K", 300.0L);
  const Real m = Number(plant, "mass_kg", 1.0L), A = Number(plant, "membrane_area_m2", 1.0L),
             F_s0 = Number(plant, "preload_N", 0.0L), k_s = Number(plant, "stiffness_N_per_m", 1.0L),
             c_s = Number(plant, "damping_Ns_per_m", 0.0L), V = Number(plant, "volume.V.volume_m3", 1.0L),
             p_res = Number(plant, "reservoir.res.pressure_Pa", 1.0L),
             slope = Number(plant, "reservoir.res.droop_Pas_per_kg", 0.0L),
             factor = Number(plant, "valve.v_g.area_factor", 1.0L),
             leak = Number(plant, "volume.V.leakage_area_m2", 0.0L),
             ambient = Number(plant, "ambient_pressure_Pa", 101300.0L);
  if (Text(plant, "valve.v_g.law", "linear") != "linear") return "the valve's area is a table";
  if (Number(plant, "valve.v_g.friction_N", 0.0L) != 0.0L) return "the membrane rubs";
  const Real k_q = factor * p_res / std::sqrt(2.0L * R_theta) * Number(plant, "valve.v_g.area_slope_m", 0.0L);
  const Real d_q = factor * Number(plant, "valve.v_g.flow_at_rest_kg_per_s", 0.0L);
  // q = (k_q x + d_q)(p_res - slope q)/p_res, solved for q.
  const auto flow = [=](Real x) {
    const Real open = std::max(0.0L, k_q * x + d_q);
    return open * p_res / (p_res + slope * open);
  };
  // At rest x follows from p_g; what the flows leave falls with p_g.
  made.start = [=](const Held& u) {
    const auto position = [&](Real p) { return (A * (u.at("p_mem") - p) - F_s0) / k_s; };
    Real low = 0.0L, high = u.at("p_mem") - (F_s0 - k_s * d_q / k_q) / A;  // the valve just closed
    for (int i = 0; i < 200; ++i) {
      const Real p = 0.5L * (low + high);
      (flow(position(p)) - Through(leak, R_theta, p, ambient, 0.0L) > u.at("q_e") ? low : high) = p;
    }
    return State{1e3L * position(high), 0.0L, high / kBar};
  };
  made.rates = [=](const Held& u, const State& s, State& rates) {
    const Real x = 1e-3L * s[0], v = 1e-3L * s[1], p = kBar * s[2];
    rates[0] = s[1];
    rates[1] = 1e3L * (A * (u.at("p_mem") - p) - F_s0 - k_s * x - c_s * v) / m;
    rates[2] = R_theta / V * (flow(x) - u.at("q_e") - Through(leak, R_theta, p, ambient, 0.0L)) / kBar;
  };
  made.outputs = {{"p_g", [](const Held&, const State& s) { return kBar * s[2]; }},
                  {"q_g", [flow](const Held&, const State& s) { return flow(1e-3L * s[0]); }},
                  {"x", [](const Held&, const State& s) { return 1e-3L * s[0]; }}};
  return "";
}

}  // namespace

Result<Answer> PressureExtrapolation(const Question& question) {
  const auto refuse = [](const std::string& why) {
    return Failure{.message = "does not apply: " + why, .signal = "oracle pressure_extrapolation", .exit_code = 2};
  };
  const Value* table = question.scenario.Find("plant");
  const std::string type = table != nullptr ? Text(*table, "type", "") : "";
  if (type != "charge_air" && type != "fuel_gas") return refuse("the plant is neither charge_air nor fuel_gas");
  for (const char* section : {"part", "control"}) {
    if (question.scenario.Find(section) != nullptr) return refuse(fmt::format("the scenario has [{}]", section));
  }
  Plant plant;
  if (const std::string fault = type == "charge_air" ? ReadChargeAir(*table, plant) : ReadFuelGas(*table, plant);
      !fault.empty()) {
    return refuse(fault);
  }
  const auto port_of = [](const Value& line, const char* key) {
    const Value* to = line.Find(key);
    if (to != nullptr && to->is_array() && to->array().size() == 1) to = &to->array()[0];
    const std::string text = to != nullptr && to->is_string() ? to->string() : "";
    return text.starts_with("plant.") ? text.substr(6) : std::string();
  };
  std::map<std::string, std::string> ports;  // by input
  Held held;
  for (const auto& [name, values] : question.inputs) {
    const Value& input = *question.scenario.FindPath("input." + name);
    if (input.Find("actuator") != nullptr) return refuse(fmt::format("input \"{}\" has an actuator", name));
    ports[name] = port_of(input, "to");
    if (ports[name].empty()) return refuse(fmt::format("input \"{}\" does not drive the plant alone", name));
    held[ports[name]] = values.empty() ? 0.0 : values[0];
  }
  Answer answer;
  std::vector<std::pair<std::string, const std::function<Real(const Held&, const State&)>*>> outputs;
  for (const std::string& name : question.outputs) {
    const Value& output = *question.scenario.FindPath("output." + name);
    if (output.Find("sensor") != nullptr) return refuse(fmt::format("output \"{}\" has a sensor", name));
    const auto found = plant.outputs.find(port_of(output, "of"));
    if (found == plant.outputs.end()) return refuse(fmt::format("output \"{}\" is no pressure or flow", name));
    outputs.emplace_back(name, &found->second);
  }

  if (question.time.empty()) return Answer{};
  State state = plant.start(held);
  namespace odeint = boost::numeric::odeint;
  for (std::size_t k = 0; k < question.time.size(); ++k) {
    // A flow output follows a held input at once: row k shows what was measured before the new commands act.
    for (const auto& [name, read] : outputs) answer[name].push_back(static_cast<double>((*read)(held, state)));
    if (k + 1 == question.time.size()) break;
    for (const auto& [name, values] : question.inputs) held[ports[name]] = values[k];
    const Real period = static_cast<Real>(question.time[k + 1]) - static_cast<Real>(question.time[k]);
    // Errors of 1e-13 bar and mm a step: below what a double of the compared run resolves over ten thousand of them.
    odeint::integrate_adaptive(
        odeint::bulirsch_stoer<State, Real, State, Real>(1e-13L, 1e-13L),
        [&](const State& s, State& rates, Real) { plant.rates(held, s, rates); }, state, 0.0L, period, 0.25L * period);
  }
  return answer;
}

}  // namespace dynoproof::oracles
