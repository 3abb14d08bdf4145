// The blind suite: draws an effect, its place, strength, noise, excitation and slightly wrong nominal values at random,
// writes what a logger would have written, has the program diagnose the file, and opens the truth only then.
//
// With --line the last line is a JSON object of counts: so a campaign makes case after case
// (bench/campaigns/blind.toml).
#include <fmt/format.h>
#include <sys/resource.h>

#include <algorithm>
#include <boost/math/distributions/beta.hpp>
#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>

#include "model/registry.h"
#include "scenario/find.h"
#include "scenario/load.h"
#include "score/series.h"
#include "tests/blind/blind_case.h"
#include "tests/blind/independent_cases.h"
#include "tests/blind/inexact.h"
#include "tests/blind/judged.h"
#include "tests/blind/reference_cases.h"
#include "trace/csv_write.h"

namespace dynoproof::blind {
namespace {

using nlohmann::json;
namespace fs = std::filesystem;

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

void Write(const fs::path& file, const Columns& columns) {
  std::vector<trace::Column> all;
  all.push_back({.name = "t", .unit = "s", .values = columns.time});
  for (const auto* signals : {&columns.inputs, &columns.outputs}) {
    for (const auto& [name, values] : *signals) all.push_back({.name = name, .unit = "", .values = values});
  }
  if (const Status failed = trace::WriteCsv(file, all)) throw std::runtime_error(failed->ToString());
}

constexpr double kResolution = 1e-4;  // to which a record without noise counts as measured
constexpr std::uint64_t kInexactDraws = 1ULL << 32;
struct Suite {
  std::string program, out = "out/blind", kind, generator, json_file;
  std::vector<std::string> scenarios, only;
  std::uint64_t seed = 1;
  std::optional<std::uint64_t> number;  // this one alone
  int cases = 20;
  double duration_s = 4.0;
  std::optional<double> noise;  // of each signal, in place of what is drawn
  int most_cpu_s = 0;           // a diagnosis that takes more is stopped; 0: no limit
  bool line = false, inexact = false;
};

/// Kind, scenario and noise of a case, and from which generator it is.
Case Drawn(const Suite& suite, std::uint64_t number, Dice& dice) {
  Case hidden;
  const double draw = dice.Uniform(0.0, 1.0);
  hidden.kind = !suite.kind.empty() ? suite.kind
                : draw < 0.5        ? "effect"
                : draw < 0.7        ? "null"
                : draw < 0.9        ? "decoy"
                                    : "unknown";
  hidden.scenario = suite.scenarios[dice.Index(suite.scenarios.size())];
  hidden.noise = std::pow(10.0, dice.Uniform(-2.7, -1.7));
  if (suite.noise) hidden.noise = std::max(*suite.noise, kResolution);  // what the effect has to show beside
  const double share = suite.generator.empty() ? kIndependent : suite.generator == "independent" ? 1.0 : 0.0;
  const bool independent = HasIndependent(hidden.scenario) && suite.only.empty() && hidden.kind != "pair" &&
                           (hidden.kind == "unknown" || dice.Uniform(0, 1) < share);
  hidden.generator = independent ? "independent" : "reference";
  if (suite.inexact) {  // by dice of their own: exact cases stay what they are
    Dice others(suite.seed, number + kInexactDraws);
    hidden.kind = hidden.kind == "effect" ? "effect" : "null";
    hidden.generator = "reference";
    DrawInexact(hidden, others);
  }
  return hidden;
}

/// Whether a case was inexact in a way that a diagnosis has no chance beside.
bool Overwhelmed(const Case& hidden) {
  return !hidden.inexact.empty() && !hidden.causes.empty() && !(hidden.size >= kMain * hidden.inexact_size);
}

/// The scenario that the program is asked to diagnose, or one whose numbers `identify` has fitted to the record; empty
/// where that failed.
std::string ScenarioOf(Case& hidden, const Suite& suite, const fs::path& folder, Dice& dice) {
  if (!hidden.IsInexactBy("fitted")) return hidden.scenario;
  Diagnostics diagnostics;
  const std::optional<Plan> plan = LoadPlan(FindScenarios(hidden.scenario, diagnostics).at(0), {}, diagnostics);
  const std::string file = (folder / "fitted.toml").string();
  fs::remove(file);
  const std::string command = fmt::format(
      "ulimit -t 100; {0} identify {1} --data {2}/record.csv --free {3} --starts 1 --out {4} >{2}/identify.txt "
      "2>{2}/identify_err.txt",
      suite.program, hidden.scenario, folder.string(), fmt::join(FittedNumbers(plan.value(), dice), ","), file);
  if (std::system(command.c_str()) != 0 || !fs::exists(file)) return "";
  // A relative change now refers to the fitted value, which nobody knows beforehand.
  for (Cause& cause : hidden.causes) {
    if (cause.effect.ends_with("_change")) cause.parameters.clear();
  }
  return file;
}

/// CPU seconds of all programs that this one has called and that have ended.
double CpuOfPrograms() {
  rusage usage{};
  getrusage(RUSAGE_CHILDREN, &usage);
  const auto seconds = [](const timeval& t) {
    return static_cast<double>(t.tv_sec) + 1e-6 * static_cast<double>(t.tv_usec);
  };
  return seconds(usage.ru_utime) + seconds(usage.ru_stime);
}

double UpperBound(int hits, int of) {
  if (of == 0 || hits == of) return 1.0;
  return boost::math::quantile(boost::math::beta_distribution<>(hits + 1, of - hits), 0.95);
}

int Run(const Suite& suite) {
  Registry registry;
  RegisterBuiltIns(registry);
  RegisterInexact(registry);
  std::map<std::string, std::map<std::string, int>> confusion, by_strength;
  std::map<std::string, std::pair<int, int>> covered;  // parameters inside their intervals, of how many
  std::pair<int, int> all_covered;
  json all = json::array();
  double seconds = 0.0;
  bool failed = false;
  int effects = 0, found = 0, wrong = 0, others = 0, alarms = 0, done = 0, at_noise = 0, right = 0;
  const std::uint64_t first = suite.number.value_or(0),
                      end = suite.number ? first + 1 : 20ULL * static_cast<std::uint64_t>(suite.cases);
  for (std::uint64_t number = first; done < suite.cases && number < end; ++number) {
    Dice dice(suite.seed, number);
    Case hidden = Drawn(suite, number, dice);
    const bool independent = hidden.generator == "independent";
    if (suite.generator == "independent" && !independent) continue;
    if (hidden.kind == "unknown" && hidden.scenario != "diagnose/heavy_duty_lumped") continue;
    Columns columns;
    try {
      if (independent) {
        Dice same = dice;
        Case plain = hidden;
        columns = FromIndependent(hidden, dice, suite.duration_s, hidden.kind == "effect", hidden.kind == "unknown");
        if (hidden.kind == "effect" || hidden.kind == "unknown") {
          hidden.size = SizeOf(columns, FromIndependent(plain, same, suite.duration_s, false, false), hidden.noise);
          if (hidden.size < kSmallestSize) continue;  // does not count
        }
      } else {
        std::optional<Columns> made = FromReference(hidden, dice, suite.duration_s, registry, suite.only);
        if (!made) continue;
        columns = *std::move(made);
      }
    } catch (const std::exception& error) {
      std::cerr << fmt::format("case {}: cannot be made: {}\n", number, error.what());
      continue;
    }
    Dice sensors(suite.seed, number + 2 * kInexactDraws);
    if (suite.inexact) RecordInexactly(columns, hidden, sensors);
    if (Overwhelmed(hidden)) continue;
    const Columns clean = columns;
    if (suite.noise != 0.0) AddNoise(columns, hidden.noise, hidden.kind == "decoy" && dice.Uniform(0, 1) < 0.5, dice);
    Quantise(columns, hidden, sensors);
    const fs::path folder = fs::path(suite.out) / fmt::format("case_{}_{}", suite.seed, number);
    fs::create_directories(folder);
    Write(folder / "record.csv", columns);
    const std::string scenario = ScenarioOf(hidden, suite, folder, sensors);
    if (scenario.empty()) {
      std::cerr << fmt::format("case {}: identify fails: {}/identify_err.txt\n", number, folder.string());
      continue;
    }
    const auto begin = std::chrono::steady_clock::now();
    const double cpu_before = CpuOfPrograms();
    const std::string limit = suite.most_cpu_s > 0 ? fmt::format("ulimit -t {}; ", suite.most_cpu_s) : "";
    const std::string command =
        limit +
        fmt::format("{} diagnose {} --data {}/record.csv --out {} --json {}/result.json >{}/table.txt 2>{}/err.txt",
                    suite.program, scenario, folder.string(), folder.string(), folder.string(), folder.string(),
                    folder.string());
    const int code = std::system(command.c_str());
    const double cpu_s = CpuOfPrograms() - cpu_before;
    const double took = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
    json result;
    std::ifstream stream(folder / "result.json");
    if (code == 0 && stream) result = json::parse(stream, nullptr, false);
    if (!result.is_object()) result = json::object();
    // Only now is the truth looked at.
    const bool stopped = suite.most_cpu_s > 0 && code != 0 && cpu_s >= 0.99 * suite.most_cpu_s;
    const std::string outcome = stopped ? "stopped" : Judged(hidden, result);
    ++done;
    seconds += took;
    failed = failed || outcome == "wrong" || outcome == "false alarm" || outcome == "broken";
    const std::string row = hidden.kind == "effect" ? hidden.causes[0].effect : "(" + hidden.kind + ")";
    ++confusion[row][outcome];
    if (!hidden.causes.empty()) {
      ++by_strength[hidden.strength < 1.0 ? "all, weak" : "all, full strength"][outcome];
      ++effects;
      wrong += outcome == "wrong" ? 1 : 0;
      found += outcome == "right" || outcome == "in the set" ? 1 : 0;
    } else if (hidden.kind != "unknown") {
      ++others;
      alarms += outcome == "false alarm" ? 1 : 0;
    }
    std::pair<int, int> inside;
    bool predicts = false;
    if (outcome == "right" && !hidden.causes.empty()) {
      ++right;
      predicts = AtNoise(hidden, result, columns, clean);
      inside = Covered(hidden, result, registry);
      at_noise += predicts ? 1 : 0;
      for (std::pair<int, int>* count : {&covered[row], &all_covered}) {
        count->first += inside.first;
        count->second += inside.second;
      }
    }
    std::string named;
    json confidence;
    for (const json& one : result.value("effects", json::array())) {
      if (confidence.is_null()) confidence = one.value("confidence", json());
      named += one["name"].get<std::string>() + "@" + one["at"].get<std::string>() + " ";
    }
    std::cout << fmt::format("{:4} {:<12} {:<28} {:<38} size {:7.1f}  -> {:<12} {} {}({:.1f} s)\n", number,
                             hidden.generator, hidden.scenario, TruthOf(hidden), hidden.size, outcome,
                             result.value("verdict", "broken"), named, took)
              << std::flush;
    json causes = json::array();
    for (const Cause& cause : hidden.causes)
      causes.push_back({{"effect", cause.effect}, {"at", cause.at}, {"parameters", cause.parameters}});
    all.push_back({{"number", number},
                   {"kind", hidden.kind},
                   {"scenario", hidden.scenario},
                   {"generator", hidden.generator},
                   {"causes", causes},
                   {"unknown", hidden.unknown},
                   {"noise", hidden.noise},
                   {"size", hidden.size},
                   {"inexact", hidden.inexact},
                   {"inexact_size", hidden.inexact_size},
                   {"strength", hidden.strength},
                   {"outcome", outcome},
                   {"verdict", result.value("verdict", "broken")},
                   {"found", named},
                   {"inside", inside.first},
                   {"of", inside.second},
                   {"at_noise", predicts},
                   {"confidence", confidence},
                   {"seconds", took},
                   {"cpu_s", cpu_s}});
    if (outcome == "right") fs::remove_all(folder);
  }
  std::cout << "\n"
            << fmt::format("{:<26}{:>7}{:>12}{:>11}{:>8}{:>7}{:>6}{:>13}{:>8}{:>9}   inside 95 %\n", "truth", "right",
                           "in the set", "abstained", "missed", "wrong", "near", "false alarm", "broken", "stopped");
  for (const auto* rows : {&confusion, &by_strength}) {
    for (const auto& [row, of_row] : *rows) {
      const auto count = [&outcomes = of_row](const char* what) {
        return outcomes.contains(what) ? outcomes.at(what) : 0;
      };
      std::cout << fmt::format(
          "{:<26}{:>7}{:>12}{:>11}{:>8}{:>7}{:>6}{:>13}{:>8}{:>9}   {}\n", row, count("right"), count("in the set"),
          count("abstained"), count("missed"), count("wrong"), count("near"), count("false alarm"), count("broken"),
          count("stopped"), covered.contains(row) ? fmt::format("{}/{}", covered[row].first, covered[row].second) : "");
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
    for (const char* outcome :
         {"right", "in the set", "abstained", "missed", "wrong", "near", "false alarm", "broken", "stopped"}) {
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
  --number N       the N-th of this seed alone, if it counts (an effect that hardly shows does not)
  --kind KIND      effect, pair, null, decoy or unknown; without it a mixture
  --scenario ID    where to hide; may be repeated (heavy_duty_lumped and r2r_soft of diagnose/)
  --generator G    independent (shares no code with the engine; some scenarios have one) or reference; else both
  --most-cpu S     stop a diagnosis after as many CPU seconds; the case is then neither right nor wrong
  --effect NAME    hide these only; may be repeated
  --noise SHARE    of each signal, in place of one drawn between 0.002 and 0.02; 0: none
  --inexact        of worlds that no model matches (tests/blind/inexact.h): effects that show at least twice as much, or nothing
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
    else if (word == "--number")
      suite.number = std::stoull(value());
    else if (word == "--generator")
      suite.generator = value();
    else if (word == "--most-cpu")
      suite.most_cpu_s = std::stoi(value());
    else if (word == "--noise")
      suite.noise = std::stod(value());
    else if (word == "--duration")
      suite.duration_s = std::stod(value());
    else if (word == "--out")
      suite.out = value();
    else if (word == "--json")
      suite.json_file = value();
    else if (word == "--inexact")
      suite.inexact = true;
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
