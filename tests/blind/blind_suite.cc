// The blind suite: draws an effect, its place, strength, noise, excitation and slightly wrong nominal values at random,
// writes what a logger would have written, has the program diagnose the file, and opens the truth only then.
//
// With --line the last line is a JSON object of counts: so a campaign makes case after case
// (bench/campaigns/blind.toml).
#include <fmt/format.h>

#include <algorithm>
#include <boost/math/distributions/beta.hpp>
#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <limits>
#include <map>
#include <nlohmann/json.hpp>
#include <set>

#include "experiment/prepare.h"
#include "scenario/load.h"
#include "score/series.h"
#include "sim/simulate.h"
#include "tests/blind/blind_case.h"
#include "tests/blind/independent_cases.h"
#include "trace/csv.h"

namespace dynoproof::blind {
namespace {

using nlohmann::json;
namespace fs = std::filesystem;

/// The same for plants of pressures; `size` is what the signal at the place swings by, and how far it goes.
std::optional<std::vector<double>> PressureStrength(const std::string& name, bool air, double u, double sign,
                                                    double swing, double peak, double duration_s) {
  if (name == "leakage") return std::vector<double>{(air ? 4e-5 : 2e-6) * u};
  if (name == "flow_area_error") return std::vector<double>{1.0 + 0.08 * u * sign};
  if (name == "actuator_hysteresis") return std::vector<double>{0.4 * swing * u};
  if (name == "valve_stiction") return std::vector<double>{8.0 * u};
  if (name == "supply_droop") return std::vector<double>{1e6 * u};
  if (name == "actuator_lag" || name == "sensor_lag") return std::vector<double>{(air ? 0.3 : 5e-3) * u};
  if (name == "actuator_delay" || name == "sensor_delay") return std::vector<double>{(air ? 0.2 : 5e-3) * u};
  if (name == "actuator_saturation") return std::vector<double>{peak - 0.8 * swing * u};
  if (name == "actuator_dead_zone") return std::vector<double>{0.3 * swing * u};
  if (name == "sensor_offset") return std::vector<double>{0.3 * swing * u * sign};
  if (name == "sensor_drift") return std::vector<double>{0.6 * swing / duration_s * u * sign};
  return std::nullopt;
}

/// Parameters at full strength: what an engineer would call a fault worth finding, in the machine's own magnitudes.
std::vector<double> FullStrength(const Plan& plan, const Effect& effect, const Place& place, const Columns& healthy,
                                 Dice& dice) {
  const std::string& name = effect.info().name;
  const auto number = [&plan](const std::string& path, double otherwise) {
    const Value* value = plan.root.FindPath(path);
    return value != nullptr && value->is_number() ? value->number() : otherwise;
  };
  const double torque = number("plant.nominal_torque_Nm", 1000.0),
               k = number("plant.shaft." + place.name + ".stiffness_Nm_per_rad", 1e6);
  const double inertia = place.kind == "rotor" ? number("plant.rotor." + place.name + ".inertia_kg_m2", 10.0)
                                               : number("plant.inertia." + place.name, 1.0);
  const double speed = torque > 2000.0 ? 1.0 : 5.0, twist = 0.5 * torque / k;
  const double u = dice.Uniform(0.7, 1.4);
  const std::string plant = plan.root.FindPath("plant.type")->string();
  if (plant != "drive_line") {
    double mean = 0.0, swing = 0.0, peak = 0.0;
    const auto& signals = place.kind == "output" ? healthy.outputs : healthy.inputs;
    if (const auto signal = signals.find(place.name); signal != signals.end()) {
      for (const double v : signal->second) mean += v / static_cast<double>(signal->second.size());
      for (const double v : signal->second) {
        swing += (v - mean) * (v - mean) / static_cast<double>(signal->second.size());
        peak = std::max(peak, std::abs(v));
      }
    }
    const auto found =
        PressureStrength(name, plant == "charge_air", u, dice.Sign(), std::sqrt(swing), peak, healthy.time.back());
    if (found) return *found;
  }
  if (name == "viscous_friction") return {0.05 * torque / speed * u};
  if (name == "coulomb_friction") return {0.06 * torque * u};
  if (name == "stribeck_friction") return {0.05 * torque * u, 0.12 * torque * u, 0.2 * speed};
  if (name == "asymmetric_friction")
    return {0.07 * torque * u, 0.03 * torque * u, 0.02 * torque / speed, 0.005 * torque / speed};
  if (name == "dahl_friction") return {0.06 * torque * u, 0.06 * torque * u / 0.01};
  if (name == "constant_load") return {0.05 * torque * u * dice.Sign()};
  if (name == "quadratic_drag") return {0.03 * torque / speed / speed * u};
  if (name == "torque_ripple")
    return {0.05 * torque * u, std::vector<double>{1, 2, 4, 6, 12, 24}[dice.Index(6)], dice.Uniform(-3, 3)};
  if (name == "inertia_change") return {0.25 * u * (dice.Uniform(0, 1) < 0.3 ? -1.0 : 1.0)};
  if (name == "stiffness_change") return {0.2 * u * dice.Sign()};
  if (name == "damping_change") return {2.0 * u};
  if (name == "distributed_inertia") return {33.0 * dice.Uniform(0.8, 1.0), 14e6 * u, 80.0 * u};
  if (name == "series_elasticity") return {5e6 * u * std::sqrt(inertia), 50.0 * u};
  if (name == "cubic_stiffness") return {0.3 * k / (twist * twist) * u};
  if (name == "backlash") return {0.3 * twist * u};
  if (name == "gap_change") return {0.2 * u};
  if (name == "contact_free_damping") return {0.1 * u};
  if (name == "oil_dynamics") return {78.3e3 * u, 232.0 * u, 1.54e5 * u};
  if (name == "viscosity_drift") return {std::min(0.9, 0.5 * u), 1.0 * u};
  if (name == "actuator_lag") return {1e-3 * u};
  if (name == "actuator_delay") return {3e-4 * u};
  if (name == "actuator_gain" || name == "sensor_gain") return {1.0 + 0.08 * u * dice.Sign()};
  if (name == "actuator_saturation") return {0.7 * 0.7 * torque * u};
  if (name == "actuator_dead_zone") return {0.15 * torque * u};
  if (name == "actuator_harmonic") return {0.08 * u * dice.Sign(), 0.05 * u};
  if (name == "sensor_offset") return {0.1 * number("output." + place.name + ".nominal", 1.0) * u * dice.Sign()};
  if (name == "sensor_delay") return {3e-4 * u};
  if (name == "sensor_lag") return {5e-4 * u};
  if (name == "sensor_drift") return {0.05 * number("output." + place.name + ".nominal", 1.0) * u};
  std::vector<double> start;
  for (const EffectParameter& p : effect.info().parameters) start.push_back(p.start);
  return start;
}

/// The same with every strength at a share of its distance from neutral.
std::vector<double> Weaker(const Effect& effect, std::vector<double> parameters, double share) {
  for (std::size_t i = 0; i < parameters.size(); ++i) {
    const double neutral = effect.info().parameters[i].neutral;
    if (std::isfinite(neutral) && neutral < effect.info().parameters[i].upper)
      parameters[i] = neutral + share * (parameters[i] - neutral);
  }
  return parameters;
}

/// What a relative change is by the scenario's own value, which the machine did not quite have before either: that is
/// what a diagnosis can find.
void AgainstNominal(Case& hidden, const Place& place, const Plan& nominal, const Plan& changed) {
  static const std::map<std::string, std::string> kKeys = {{"inertia_change", "inertia_kg_m2"},
                                                           {"stiffness_change", "stiffness_Nm_per_rad"},
                                                           {"damping_change", "damping_Nms_per_rad"}};
  const auto key = kKeys.find(hidden.effect);
  if (key == kKeys.end()) return;
  const std::string of = fmt::format("plant.{}.{}", place.kind, place.name);
  const std::string path = place.kind == "inertia" ? of : of + "." + key->second;
  hidden.parameters = {changed.root.FindPath(path)->number() / nominal.root.FindPath(path)->number() - 1.0};
}

/// Runs a plan with `reference`: another method, step and tolerance than what diagnoses.
Columns Simulated(const Plan& plan, const Registry& registry) {
  Diagnostics diagnostics;
  PrepareOptions options;
  options.solver = "reference";
  Plan bare = plan;
  bare.root.Erase("check");
  const std::unique_ptr<Prepared> prepared = Prepare(bare, options, registry, diagnostics);
  if (prepared == nullptr) throw std::runtime_error(diagnostics.Format());
  const auto solver = MakeSolver("reference", *prepared->rig);
  if (!solver.ok()) throw std::runtime_error(solver.failure().ToString());
  const Result<Samples> samples = Simulate(*prepared->rig, **solver);
  if (!samples.ok()) throw std::runtime_error(samples.failure().ToString());
  Columns columns{samples->time, {}, {}};
  for (std::size_t i = 0; i < prepared->rig->inputs.size(); ++i)
    columns.inputs[prepared->rig->inputs[i].name] = samples->inputs[i];
  for (std::size_t i = 0; i < prepared->rig->outputs.size(); ++i) {
    const std::string& name = prepared->rig->outputs[i].name;
    if (name != "phi_1") columns.outputs[name] = samples->outputs[i];
  }
  return columns;
}

/// Another excitation than the scenario's own.
void Excite(Plan& plan, Dice& dice, double duration_s) {
  if (plan.root["plant"]["type"].string() == "drive_line") plan.root["run"]["duration_s"] = Value(duration_s);
  // An undamped mode adds up the errors of all steps: a scenario that asks for more gets it.
  Value& tolerance = plan.root["run"]["reference"]["relative_tolerance"];
  tolerance = Value(std::min(1e-7, tolerance.is_number() ? tolerance.number() : 1.0));
  for (Value::Entry& input : plan.root["input"].table()) {
    Value* sources = input.value["source"].Find("sources");
    Value::Array single{input.value["source"]};
    Value::Array& list = sources != nullptr && sources->is_array() ? sources->array() : single;
    for (Value& source : list) {
      if (source.Find("seed") != nullptr) source["seed"] = Value(static_cast<std::int64_t>(dice.Uniform(1, 1e6)));
      if (source.Find("rms") != nullptr) source["rms"] = Value(source["rms"].number() * dice.Uniform(0.7, 1.3));
    }
    if (sources == nullptr) input.value["source"] = single.front();
  }
}

/// Nominal values slightly off, as data sheets are.
void Detune(Plan& plan, Dice& dice, double spread) {
  const auto each = [&](const std::string& path, double size) {
    Value* value = plan.root.FindPath(path);
    if (value != nullptr && value->is_number())
      *value = Value(value->number() * (1.0 + size * dice.Uniform(-1.0, 1.0)));
  };
  for (const char* key : {"mass_kg", "stiffness_N_per_m", "damping_Ns_per_m", "preload_N"})
    each(std::string("plant.") + key, spread);
  for (const char* section : {"inertia", "rotor", "shaft", "volume"}) {
    const Value* table = plan.root.FindPath(std::string("plant.") + section);
    for (const std::string& name : table != nullptr ? KeysOf(*table) : std::vector<std::string>{}) {
      const std::string path = fmt::format("plant.{}.{}", section, name);
      each(path, spread);
      each(path + ".volume_m3", spread);
      each(path + ".inertia_kg_m2", spread);
      each(path + ".stiffness_Nm_per_rad", spread);
      each(path + ".damping_Nms_per_rad", 10.0 * spread);
    }
  }
}

void AddNoise(Columns& columns, double share, bool coloured, Dice& dice) {
  for (auto& [name, values] : columns.outputs) {
    const double sigma = share * score::StandardDeviation(values), pole = coloured ? dice.Uniform(0.5, 0.95) : 0.0;
    double state = 0.0;
    for (double& v : values) {
      state = pole * state + std::sqrt(1.0 - pole * pole) * dice.Normal();
      v += sigma * state;
    }
  }
}

/// RMS of the difference over the noise, of the signal that shows most; of the training part or the hold-out (the last
/// 30 %), whichever shows less: nobody finds what one of them does not hold.
double SizeOf(const Columns& with, const Columns& without, double noise) {
  double smallest = std::numeric_limits<double>::infinity();
  for (const auto& [from, to] : {std::pair{0.0, 0.7}, {0.7, 1.0}}) {
    double largest = 0.0;
    for (const auto& [name, values] : with.outputs) {
      const auto rows = static_cast<double>(values.size());
      std::vector<double> difference;
      for (auto i = static_cast<std::size_t>(from * rows); i < static_cast<std::size_t>(to * rows); ++i)
        difference.push_back(values[i] - without.outputs.at(name)[i]);
      largest = std::max(largest, score::RootMeanSquare(difference) / (noise * score::StandardDeviation(values)));
    }
    smallest = std::min(smallest, largest);
  }
  return smallest;
}

void Write(const fs::path& file, const Columns& columns) {
  std::vector<trace::Column> all;
  all.push_back({.name = "t", .unit = "s", .values = columns.time});
  for (const auto* signals : {&columns.inputs, &columns.outputs}) {
    for (const auto& [name, values] : *signals) all.push_back({.name = name, .unit = "", .values = values});
  }
  if (const Status failed = trace::WriteCsv(file, all)) throw std::runtime_error(failed->ToString());
}

struct Suite {
  std::string program, out = "out/blind", kind, json_file;
  std::vector<std::string> scenarios, only;
  std::uint64_t seed = 1;
  int cases = 20;
  double duration_s = 4.0;
  bool line = false;
};

std::string Judged(const Case& hidden, const json& result) {
  const std::string verdict = result.value("verdict", "broken");
  const std::string truth = hidden.effect + "@" + hidden.at;
  if (verdict == "broken") return "broken";
  if (hidden.kind == "unknown") return verdict == "effect_found" || verdict == "no_effect" ? "wrong" : "abstained";
  if (hidden.kind != "effect")
    return verdict == "no_effect" ? "right" : verdict == "unexplained" ? "abstained" : "false alarm";
  if (verdict == "effect_found") {
    const json& effects = result["effects"];
    const bool same = effects.size() == 1 && effects[0]["name"] == hidden.effect && effects[0]["at"] == hidden.at;
    return same ? "right" : "wrong";
  }
  if (verdict == "ambiguous") {
    for (const json& set : result["ambiguous_with"]) {
      for (const json& one : set) {
        if (one == truth) return "in the set";
      }
    }
    return "wrong";
  }
  return verdict == "no_effect" ? "missed" : "abstained";
}

/// How many of the true parameters lie inside their interval, of a cause that was named right.
int Covered(const Case& hidden, const json& result, const Registry& registry) {
  const Effect& effect = *registry.FindEffect(hidden.effect);
  int inside = 0;
  for (std::size_t i = 0; i < hidden.parameters.size(); ++i) {
    const json& ci = result["effects"][0]["parameters"][effect.info().parameters[i].name]["ci95"];
    inside += hidden.parameters[i] >= ci[0].get<double>() && hidden.parameters[i] <= ci[1].get<double>() ? 1 : 0;
  }
  return inside;
}

/// Whether the extended scenario predicts the hold-out (the last 30 %) within 1.1 times the noise, every signal.
bool AtNoise(const Case& hidden, const json& result, const Columns& columns, const Columns& clean) {
  for (const auto& [name, values] : columns.outputs) {
    const std::vector<double> held(
        values.begin() + static_cast<std::ptrdiff_t>(0.7 * static_cast<double>(values.size())), values.end());
    const double error = result["gain"]["holdout"][name]["nrmse_after"].get<double>() * score::StandardDeviation(held);
    if (!(error <= 1.1 * hidden.noise * score::StandardDeviation(clean.outputs.at(name)))) return false;
  }
  return true;
}

double UpperBound(int hits, int of) {
  if (of == 0 || hits == of) return 1.0;
  return boost::math::quantile(boost::math::beta_distribution<>(hits + 1, of - hits), 0.95);
}

int Run(const Suite& suite) {
  Registry registry;
  RegisterBuiltIns(registry);
  std::map<std::string, std::map<std::string, int>> confusion, by_strength;
  std::map<std::string, std::pair<int, int>> covered;  // parameters inside their intervals, of how many
  std::pair<int, int> all_covered;
  json all = json::array();
  double seconds = 0.0;
  bool failed = false;
  int effects = 0, found = 0, wrong = 0, others = 0, alarms = 0, done = 0, at_noise = 0, right = 0;
  for (std::uint64_t number = 0; done < suite.cases && number < 20ULL * static_cast<std::uint64_t>(suite.cases);
       ++number) {
    Dice dice(suite.seed, number);
    Case hidden;
    const double draw = dice.Uniform(0.0, 1.0);
    hidden.kind = !suite.kind.empty() ? suite.kind
                  : draw < 0.5        ? "effect"
                  : draw < 0.7        ? "null"
                  : draw < 0.9        ? "decoy"
                                      : "unknown";
    hidden.scenario = suite.scenarios[dice.Index(suite.scenarios.size())];
    hidden.noise = std::pow(10.0, dice.Uniform(-2.7, -1.7));
    const bool independent = HasIndependent(hidden.scenario) && suite.only.empty() &&
                             (hidden.kind == "unknown" || dice.Uniform(0, 1) < kIndependent);
    hidden.generator = independent ? "independent" : "reference";
    if (hidden.kind == "unknown" && hidden.scenario != "diagnose/heavy_duty_lumped") continue;
    Columns columns;
    try {
      if (independent) {
        Dice same = dice;
        Case plain = hidden;
        columns = FromIndependent(hidden, dice, suite.duration_s, hidden.kind == "effect", hidden.kind == "unknown");
        if (hidden.kind == "effect" || hidden.kind == "unknown") {
          hidden.size = SizeOf(columns, FromIndependent(plain, same, suite.duration_s, false, false), hidden.noise);
          if (hidden.size < 3.0) continue;  // does not count
        }
      } else {
        Diagnostics diagnostics;
        const auto files = FindScenarios(hidden.scenario, diagnostics);
        std::optional<Plan> plan = LoadPlan(files.at(0), {}, diagnostics);
        if (!plan) throw std::runtime_error(diagnostics.Format());
        Excite(*plan, dice, suite.duration_s);
        Plan nominal = *plan;
        Detune(*plan, dice, hidden.kind == "null" ? 0.0 : 0.003);
        if (hidden.kind == "decoy" && dice.Uniform(0, 1) < 0.4 && plan->root["plant"]["type"].string() == "drive_line")
          plan->root["plant"]["initial_speed_rad_per_s"] = Value(dice.Uniform(-3.0, 3.0));
        if (hidden.kind == "effect") {
          std::vector<std::pair<const Effect*, Place>> choices;
          const std::vector<const Effect*> known = registry.Effects();
          std::vector<const Effect*> possible;
          for (const Effect* effect : known) {
            if (!effect->Places(*plan).empty() &&
                (suite.only.empty() ||
                 std::find(suite.only.begin(), suite.only.end(), effect->info().name) != suite.only.end()))
              possible.push_back(effect);
          }
          const Effect* effect = possible.at(dice.Index(possible.size()));
          std::vector<Place> places = effect->Places(*plan);
          std::erase_if(places, [](const Place& place) { return place.name == "phi_1"; });
          const Place place = places.at(dice.Index(places.size()));
          const Columns without = Simulated(*plan, registry);
          const std::vector<double> full = FullStrength(*plan, *effect, place, without, dice);
          hidden.strength = std::vector<double>{0.3, 1.0, 1.0}[dice.Index(3)];
          hidden.parameters = Weaker(*effect, full, hidden.strength);
          Plan changed = *plan;
          effect->Apply(changed, place, hidden.parameters);
          columns = Simulated(changed, registry);
          hidden.effect = effect->info().name;
          hidden.at = place.ToString();
          AgainstNominal(hidden, place, nominal, changed);
          hidden.size = SizeOf(columns, without, hidden.noise);
          if (hidden.size < 3.0) continue;  // does not count
        } else {
          columns = Simulated(*plan, registry);
        }
      }
    } catch (const std::exception& error) {
      std::cerr << fmt::format("case {}: cannot be made: {}\n", number, error.what());
      continue;
    }
    const Columns clean = columns;
    AddNoise(columns, hidden.noise, hidden.kind == "decoy" && dice.Uniform(0, 1) < 0.5, dice);
    const fs::path folder = fs::path(suite.out) / fmt::format("case_{}_{}", suite.seed, number);
    fs::create_directories(folder);
    Write(folder / "record.csv", columns);
    const auto begin = std::chrono::steady_clock::now();
    const std::string command = fmt::format(
        "{} diagnose {} --data {}/record.csv --out {} --json {}/result.json >{}/table.txt 2>{}/err.txt", suite.program,
        hidden.scenario, folder.string(), folder.string(), folder.string(), folder.string(), folder.string());
    const int code = std::system(command.c_str());
    const double took = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
    json result;
    std::ifstream stream(folder / "result.json");
    if (code == 0 && stream) result = json::parse(stream, nullptr, false);
    if (!result.is_object()) result = json::object();
    // Only now is the truth looked at.
    const std::string outcome = Judged(hidden, result);
    ++done;
    seconds += took;
    failed = failed || outcome == "wrong" || outcome == "false alarm" || outcome == "broken";
    const std::string row = hidden.kind == "effect" ? hidden.effect : "(" + hidden.kind + ")";
    ++confusion[row][outcome];
    if (hidden.kind == "effect") {
      ++by_strength[hidden.strength < 1.0 ? "all, weak" : "all, full strength"][outcome];
      ++effects;
      wrong += outcome == "wrong" ? 1 : 0;
      found += outcome == "right" || outcome == "in the set" ? 1 : 0;
    } else if (hidden.kind != "unknown") {
      ++others;
      alarms += outcome == "false alarm" ? 1 : 0;
    }
    int inside = 0;
    bool predicts = false;
    if (outcome == "right" && hidden.kind == "effect") {
      ++right;
      predicts = AtNoise(hidden, result, columns, clean);
      inside = Covered(hidden, result, registry);
      at_noise += predicts ? 1 : 0;
      for (std::pair<int, int>* count : {&covered[row], &all_covered}) {
        count->first += inside;
        count->second += static_cast<int>(hidden.parameters.size());
      }
    }
    std::string named;
    for (const json& one : result.value("effects", json::array()))
      named += one["name"].get<std::string>() + "@" + one["at"].get<std::string>() + " ";
    std::cout << fmt::format("{:4} {:<12} {:<28} {:<22}{:<16} size {:7.1f}  -> {:<12} {} {}({:.1f} s)\n", number,
                             hidden.generator, hidden.scenario, hidden.effect.empty() ? hidden.kind : hidden.effect,
                             hidden.at, hidden.size, outcome, result.value("verdict", "broken"), named, took)
              << std::flush;
    all.push_back({{"number", number},
                   {"kind", hidden.kind},
                   {"scenario", hidden.scenario},
                   {"generator", hidden.generator},
                   {"effect", hidden.effect},
                   {"at", hidden.at},
                   {"parameters", hidden.parameters},
                   {"noise", hidden.noise},
                   {"size", hidden.size},
                   {"strength", hidden.strength},
                   {"outcome", outcome},
                   {"verdict", result.value("verdict", "broken")},
                   {"found", named},
                   {"inside", inside},
                   {"at_noise", predicts},
                   {"seconds", took}});
    if (outcome == "right") fs::remove_all(folder);
  }
  std::cout << "\n"
            << fmt::format("{:<26}{:>7}{:>12}{:>11}{:>8}{:>7}{:>13}{:>8}   inside 95 %\n", "truth", "right",
                           "in the set", "abstained", "missed", "wrong", "false alarm", "broken");
  for (const auto* rows : {&confusion, &by_strength}) {
    for (const auto& [row, outcomes] : *rows) {
      const auto count = [&outcomes](const char* what) { return outcomes.contains(what) ? outcomes.at(what) : 0; };
      std::cout << fmt::format(
          "{:<26}{:>7}{:>12}{:>11}{:>8}{:>7}{:>13}{:>8}   {}\n", row, count("right"), count("in the set"),
          count("abstained"), count("missed"), count("wrong"), count("false alarm"), count("broken"),
          covered.contains(row) ? fmt::format("{}/{}", covered[row].first, covered[row].second) : "");
    }
  }
  std::cout << fmt::format(
      "\n{} cases, {:.1f} s each; wrong cause {} of {} (95 % upper bound {:.1f} %), false alarms {} of {} ({:.1f} %)\n"
      "of {} right causes the extended scenario predicts {} within 1.1 times the noise; {} of {} parameters lie inside "
      "their intervals\n",
      done, seconds / std::max(1, done), wrong, effects, 100.0 * UpperBound(wrong, effects), alarms, others,
      100.0 * UpperBound(alarms, others), right, at_noise, all_covered.first, all_covered.second);
  if (!suite.json_file.empty()) std::ofstream(suite.json_file) << all.dump(2) << "\n";
  if (suite.line) {
    json line = {{"cases", done},
                 {"effects", effects},
                 {"others", others},
                 {"causes", right},
                 {"predicted", at_noise},
                 {"parameters", all_covered.second},
                 {"inside", all_covered.first}};
    for (const char* outcome : {"right", "in the set", "abstained", "missed", "wrong", "false alarm", "broken"}) {
      line[outcome] = 0;
      for (const auto& [row, outcomes] : confusion)
        line[outcome] = line[outcome].get<int>() + (outcomes.contains(outcome) ? outcomes.at(outcome) : 0);
    }
    std::cout << line.dump() << "\n";
    return 0;  // the campaign judges
  }
  // To abstain from everything is no skill.
  return failed || 2 * found < effects ? 1 : 0;
}

}  // namespace
}  // namespace dynoproof::blind

constexpr const char* kHelp =
    R"(blind_suite PROGRAM: hides effects in records, has PROGRAM diagnose them, and opens the truth afterwards

  --cases N        how many (20)
  --seed S         which ones (1)
  --kind KIND      effect, null, decoy or unknown; without it a mixture
  --scenario ID    where to hide; may be repeated (heavy_duty_lumped and r2r_soft of diagnose/)
  --effect NAME    hide these only; may be repeated
  --duration S     of records of drive lines (4)
  --out DIR        records and results of cases that did not come out right (out/blind)
  --json FILE      all cases with their truth
  --line           ends with counts as one JSON line, for campaigns

Exit code 1: a wrong cause, a false alarm, a diagnosis that broke, or fewer than half of the effects found.

  blind_suite build/dynoproof --cases 40 --seed 7 --kind effect --scenario diagnose/coupling --duration 2
)";

int main(int argc, char** argv) {
  dynoproof::blind::Suite suite;
  for (int i = 1; i < argc; ++i) {
    const std::string word = argv[i];
    const auto value = [&] { return ++i < argc ? std::string(argv[i]) : std::string(); };
    if (word == "--cases")
      suite.cases = std::stoi(value());
    else if (word == "--seed")
      suite.seed = std::stoull(value());
    else if (word == "--scenario")
      suite.scenarios.push_back(value());
    else if (word == "--effect")
      suite.only.push_back(value());
    else if (word == "--kind")
      suite.kind = value();
    else if (word == "--duration")
      suite.duration_s = std::stod(value());
    else if (word == "--out")
      suite.out = value();
    else if (word == "--json")
      suite.json_file = value();
    else if (word == "--line")
      suite.line = true;
    else if (word == "--help" || word.starts_with("-")) {
      std::cout << kHelp;
      return word == "--help" ? 0 : 2;
    } else
      suite.program = word;
  }
  if (suite.program.empty()) {
    std::cout << kHelp;
    return 2;
  }
  if (suite.scenarios.empty()) suite.scenarios = {"diagnose/heavy_duty_lumped", "diagnose/r2r_soft"};
  return dynoproof::blind::Run(suite);
}
