#include "diagnosis/extend.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <set>

#include "base/atomic_file.h"
#include "experiment/measured_record.h"
#include "scenario/find.h"
#include "scenario/load.h"
#include "score/series.h"

namespace dynoproof::diagnosis {
namespace {

constexpr const char* kExtended = "extended.toml";

namespace fs = std::filesystem;

std::string Number(double value) { return InlineToml(value); }

std::string IncludeOf(const DiagnoseOptions& options) {
  const fs::path file = fs::weakly_canonical(options.scenario_file), out = fs::weakly_canonical(options.out);
  return fs::relative(file, out).generic_string();
}

/// The nominal scenario as `bless` finds it from any folder: by its id, or by its place where it is none of the
/// library.
std::string NominalOf(const EstimationProblem& problem, const DiagnoseOptions& options) {
  const fs::path file = fs::weakly_canonical(options.scenario_file);
  const fs::path by_id = fs::weakly_canonical(fs::path(ScenarioFolder()) / (problem.plan().id + ".toml"));
  return file == by_id ? problem.plan().id : file.generic_string();
}

/// [extension]. Lists stand there even with nothing in them: the extension of an extension would inherit the other's.
/// The start belongs to these records; a run that another one drives begins where that does.
std::string ExtensionTable(const EstimationProblem& problem, const identification::Hypothesis& hypothesis,
                           const DiagnoseOptions& options) {
  Value::Array set, data, start;
  for (std::size_t i = 0; i < problem.nuisances().size(); ++i) {
    const Nuisance& nuisance = problem.nuisances()[i];
    if (!nuisance.start || (hypothesis.z[i] == 0.0 && problem.plan().root.FindPath(nuisance.path) == nullptr)) continue;
    start.emplace_back(
        fmt::format("{}={}", nuisance.path, Number(ValueOf(nuisance, hypothesis.z[i], problem.plan()).value)));
  }
  for (const std::string& change : options.overrides) set.emplace_back(change);
  for (const MappedRecord& record : problem.records()) data.emplace_back(HashOf(record.file));
  return ToToml(Value{{"extension", Value{{"of", NominalOf(problem, options)},
                                          {"set", std::move(set)},
                                          {"data", std::move(data)},
                                          {"start", std::move(start)}}}});
}

Result<std::string> Write(const DiagnoseOptions& options, const char* name, const std::string& text) {
  const fs::path file = fs::path(options.out) / name;
  if (Status failed = WriteFileAtomically(file, text)) return *failed;
  return file.generic_string();
}

/// The value of --set as TOML; arrays and tables as they were written.
std::string AsToml(const Value& value, const std::string& written) {
  return value.is_array() || value.is_table() ? written : InlineToml(value);
}

// Of the realtime solver with a nonlinear law: 1e-4 is seen for a cubic spring in substeps.
constexpr double kSolver = 5e-4;

/// How far apart the two solvers may be, in the signal's spread: a tenth of what the record can tell.
double LimitOf(const ComparedOutput& channel, const Diagnosis& diagnosis) {
  const auto floor = diagnosis.floor_by_signal.find(channel.name);
  const double noise =
      floor != diagnosis.floor_by_signal.end() && channel.spread > 0.0 ? floor->second / channel.spread : 0.0;
  return std::max(0.1 * noise, kSolver);
}

/// What the extended scenario is held to: both solvers closer than the record can tell, in windows where motion is
/// chaotic.
std::string OwnChecks(const EstimationProblem& problem, const Diagnosis& diagnosis) {
  const bool windows = problem.plan().root.FindPath("prediction_window_s") != nullptr;
  std::set<std::string> signals;
  std::string text;
  for (const ComparedOutput& channel : problem.channels()) {
    if (!signals.insert(channel.name).second) continue;
    text += fmt::format(
        "\n[[check]]\nkind = \"{}\"\nsignal = \"{}\"\nnrmse = {}\n"
        "origin = \"a tenth of the record's noise, and at least {}, the solvers' distance under a nonlinear law\"\n",
        windows ? "windows" : "solvers", channel.name, Number(LimitOf(channel, diagnosis)), kSolver);
  }
  return text;
}

}  // namespace

Result<std::string> WriteExtended(const EstimationProblem& problem, const identification::Hypothesis& hypothesis,
                                  const Diagnosis& diagnosis, const DiagnoseOptions& options) {
  std::string text = fmt::format(
      "# {} with what a diagnosis found. Intervals are 95 %.\n"
      "include = [\"{}\"]\n",
      problem.plan().id, IncludeOf(options));
  if (problem.plan().root.Find("check") != nullptr)
    text += "without = [\"check\"]  # limits and oracles of the nominal model\n";
  // Values fitted along, as dotted tables: [plant.inertia] I5 = ...
  std::set<std::string> tables;
  std::vector<std::pair<std::string, std::string>> lines;
  for (std::size_t i = 0; i < problem.nuisances().size(); ++i) {
    const Nuisance& nuisance = problem.nuisances()[i];
    if (nuisance.start || hypothesis.z[i] == 0.0) continue;
    const std::size_t dot = nuisance.path.rfind('.');
    // An effect may remove the part; its value is then of no use.
    const NuisanceValue value = ValueOf(nuisance, hypothesis.z[i], problem.plan());
    lines.emplace_back(nuisance.path.substr(0, dot),
                       fmt::format("{} = {}  # nominal {}, fitted along\n", nuisance.path.substr(dot + 1),
                                   Number(value.value), Number(value.nominal)));
    tables.insert(lines.back().first);
  }
  if (problem.NeedsFinerSteps(hypothesis)) {
    lines.emplace_back("run.realtime", fmt::format("substeps = {}  # friction that sticks needs finer ones\n",
                                                   SubstepsOf(problem.PlanOf(hypothesis))));
    tables.insert("run.realtime");
  }
  // What --set changed belongs to the nominal model, which the file alone does not have.
  for (const std::string& change : options.overrides) {
    const std::string path = change.substr(0, change.find('=')), key = path.substr(path.rfind('.') + 1);
    const std::string table = path.size() > key.size() ? path.substr(0, path.size() - key.size() - 1) : "";
    const bool fitted = std::any_of(lines.begin(), lines.end(), [&](const auto& line) {
      return line.first == table && line.second.starts_with(key + " = ");
    });
    const Value* value = problem.plan().root.FindPath(path);
    if (fitted || value == nullptr) continue;
    const std::string text_of =
        fmt::format("{} = {}  # by --set\n", key, AsToml(*value, change.substr(change.find('=') + 1)));
    if (table.empty()) {
      text += text_of;
      continue;
    }
    lines.emplace_back(table, text_of);
    tables.insert(table);
  }
  text += ExtensionTable(problem, hypothesis, options);
  for (const std::string& table : tables) {
    text += fmt::format("\n[{}]\n", table);
    for (const auto& [in, line] : lines) {
      if (in == table) text += line;
    }
  }
  for (std::size_t e = 0; e < hypothesis.effects.size(); ++e) {
    const EffectInstance& instance = hypothesis.effects[e];
    text += fmt::format("\n[[effect]]\nname = \"{}\"\nat = \"{}\"\n", instance.effect->info().name,
                        instance.place.ToString());
    if (instance.parameters.empty()) continue;
    text += "[effect.parameters]\n";
    for (std::size_t i = 0; i < instance.parameters.size(); ++i) {
      const FoundParameter& found = diagnosis.effects[e].parameters[i];
      text += fmt::format("{} = {}  # {}, {} ... {}\n", found.name, Number(instance.parameters[i]), found.unit,
                          found.Text(found.lower), found.Text(found.upper));
    }
  }
  return Write(options, kExtended, text + OwnChecks(problem, diagnosis));
}

bool IsNoBetterThanGiven(const std::optional<Share>& explained, bool exact) {
  return !exact && explained && !(explained->value > 0.0);
}

void RemoveExtended(const DiagnoseOptions& options) {
  std::error_code none_there;
  std::filesystem::remove(std::filesystem::path(options.out) / kExtended, none_there);
}

std::string SeparatingText(const EstimationProblem& problem, const std::vector<EffectInstance>& alike) {
  std::set<std::string> kinds, names, places;
  for (const EffectInstance& instance : alike) {
    kinds.insert(instance.place.kind);
    names.insert(instance.effect->info().name);
    places.insert(instance.place.ToString());
  }
  if (kinds.contains("input") && kinds.contains("output"))
    return "record a second, independent sensor beside the output, or the actuator's own feedback: what the input does "
           "shows in every output, what one sensor does only in its own";
  if (kinds.size() == 1 && kinds.contains("output"))
    return "calibrate the sensors at standstill and under a known load; record again";
  if (names.size() == 1)
    return fmt::format(
        "the effect is the same, the place is not: excite the modes in which these places move against each other "
        "(broad band, up to the highest mode), and record a speed or torque between them ({})",
        fmt::join(places, ", "));
  const std::string& own = problem.registry().PlantOf(problem.plan()).separating_experiment;
  if (!own.empty()) return own;
  return "drive the line with a slow triangle of torque through standstill in both directions, at two amplitudes a "
         "factor of four apart, with a small broad-band torque on top: laws then differ in how they grow with speed, "
         "twist and amplitude, places in how the higher modes see them";
}

Result<std::string> WriteSeparating(const EstimationProblem& problem, const std::vector<EffectInstance>& alike,
                                    const DiagnoseOptions& options) {
  const double duration_s = std::max(10.0, problem.records().front().end_s);
  std::string text =
      fmt::format("# {}: an experiment to tell candidates apart.\n# {}\ninclude = [\"{}\"]\n\n[run]\nduration_s = {}\n",
                  problem.plan().id, SeparatingText(problem, alike), IncludeOf(options), Number(duration_s));
  int seed = 101;
  for (const auto& [name, series] : problem.records().front().inputs) {
    const auto [least, most] = std::minmax_element(series.values->begin(), series.values->end());
    // Torques swing through zero; a flap, a flow or a pressure about where it stood.
    const double mean = *least * *most > 0.0 ? 0.5 * (*least + *most) : 0.0;
    const double peak = std::max({std::abs(*least - mean), std::abs(*most - mean), 1e-9 * std::abs(mean), 1e-9});
    // Slow swings of two sizes, and a multisine up to a fifth of the sampling rate.
    text += fmt::format(
        "\n[input.{}.source]\ntype = \"sum\"\nsources = [\n"
        "  {{ type = \"constant\", value = {} }},\n"
        "  {{ type = \"multisine\", rms = {}, low_Hz = {}, high_Hz = {}, lines = 400, seed = {} }},\n"
        "  {{ type = \"sine_sum\", amplitudes = [{}, {}], frequencies_Hz = [{}, {}], phases_rad = [0.0, 0.0] "
        "}},\n]\n",
        name, Number(mean), Number(0.25 * peak), Number(10.0 / duration_s),
        Number(0.2 / score::MedianStep(*series.time)), seed++, Number(0.8 * peak), Number(0.2 * peak),
        Number(1.0 / duration_s), Number(7.0 / duration_s));
  }
  return Write(options, "separate.toml", text);
}

}  // namespace dynoproof::diagnosis
