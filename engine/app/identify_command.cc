// dynoproof identify
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>

#include "app/app.h"
#include "app/measured.h"
#include "base/atomic_file.h"
#include "base/text.h"
#include "experiment/measured_record.h"
#include "experiment/settings.h"
#include "identification/identify.h"
#include "model/effect.h"
#include "scenario/load.h"

namespace dynoproof::app {
namespace {

struct IdentifyArguments {
  Common common;
  std::string scenario;
  std::vector<std::string> data, maps, overrides, free, bounds;
  std::string method = "corrected", out;
  int starts = 4;
};

/// What `--method` may name, each with what it makes small.
std::string HelpOfMethods() {
  std::string help = "what is made small (default: corrected)";
  for (const auto& [name, method] : identification::Methods()) help += fmt::format("; {}: {}", name, method.help);
  return help;
}

/// KEY=LOW:HIGH, of one of the keys.
void ReadBound(const std::string& text, std::vector<identification::FreeKey>& keys, Diagnostics& diagnostics) {
  const std::size_t equals = text.find('='), colon = text.find(':', equals);
  const auto number = [&](std::size_t from, std::size_t to) {
    const std::string part = text.substr(from, to - from);
    char* end = nullptr;
    const double value = std::strtod(part.c_str(), &end);
    return !part.empty() && *end == '\0' ? value : std::nan("");
  };
  if (equals != std::string::npos && colon != std::string::npos) {
    const double low = number(equals + 1, colon), high = number(colon + 1, text.size());
    const auto key = std::find_if(keys.begin(), keys.end(), [&](const identification::FreeKey& one) {
      return one.key == text.substr(0, equals);
    });
    if (key == keys.end()) {
      diagnostics.Error({"--bound"}, fmt::format("\"{}\" is none of the --free keys", text.substr(0, equals)));
      return;
    }
    if (key->bounds) {
      diagnostics.Error({"--bound"}, fmt::format("\"{}\" has bounds already", key->key));
      return;
    }
    if (std::isfinite(low) && std::isfinite(high) && low < high) {
      key->bounds = {low, high};
      return;
    }
  }
  diagnostics.Error({"--bound"}, fmt::format("\"{}\" gives no bounds", text),
                    "KEY=LOW:HIGH, e.g. plant.inertia.I5=0.01:10");
}

/// The number that was most likely meant, of those that are written and of the defaults.
std::string NumberMeant(const std::string& key, const Registry& registry, const Plan& plan) {
  std::vector<std::string> numbers;
  for (const Setting& one : SettingsOf(plan, registry)) {
    if (ParseTomlValue(one.value).is_number()) numbers.push_back(one.path);
  }
  const std::optional<std::string> near = Closest(key, numbers);
  std::string hint = near ? fmt::format("did you mean \"{}\"?", *near) : "a dotted path such as plant.inertia.I5";
  const std::size_t dot = key.rfind('.');
  const Value* table = dot == std::string::npos ? nullptr : plan.root.FindPath(key.substr(0, dot));
  if (table != nullptr && table->is_table())
    hint += fmt::format(" Where the scenario leaves it to its default: --set {}=VALUE", key);
  return hint;
}

/// Writes the default of a number that the scenario leaves out into the plan, where there is one.
void WriteDefault(const std::string& key, const Registry& registry, Plan& plan) {
  const std::vector<Setting> settings = SettingsOf(plan, registry);
  const auto setting =
      std::find_if(settings.begin(), settings.end(), [&key](const Setting& one) { return one.path == key; });
  const std::size_t dot = key.rfind('.');
  if (setting == settings.end() || setting->from != Setting::kDefault || dot == std::string::npos) return;
  const Value value = ParseTomlValue(setting->value);
  Value* table = plan.root.FindPath(key.substr(0, dot));
  // A whole number is a count or a seed.
  if (table != nullptr && table->is_table() && value.is_number() && setting->type == "number")
    (*table)[key.substr(dot + 1)] = Value(value.number());
}

/// The numbers to fit, each with a magnitude to search around.
std::vector<identification::FreeKey> FreeKeys(const IdentifyArguments& arguments, const Registry& registry, Plan& plan,
                                              Diagnostics& diagnostics) {
  std::vector<identification::FreeKey> keys;
  for (const std::string& key : arguments.free) {
    if (std::count(arguments.free.begin(), arguments.free.end(), key) == 1)
      keys.push_back({key, std::nullopt});
    else
      diagnostics.Error({"--free"}, fmt::format("\"{}\" stands there twice", key));
  }
  for (const std::string& bound : arguments.bounds) ReadBound(bound, keys, diagnostics);
  for (const identification::FreeKey& free : keys) {
    if (plan.root.FindPath(free.key) == nullptr) WriteDefault(free.key, registry, plan);
    const Value* value = plan.root.FindPath(free.key);
    if (value == nullptr || !value->is_number())
      diagnostics.Error({"--free"}, fmt::format("\"{}\" is no number of the scenario", free.key),
                        NumberMeant(free.key, registry, plan));
    else if (value->number() == 0.0 && !free.bounds)
      diagnostics.Error({"--free"}, fmt::format("\"{}\" is 0: it gives no magnitude to search around", free.key),
                        fmt::format("--bound {0}=LOW:HIGH, or --set {0}=VALUE", free.key));
  }
  return keys;
}

/// With links followed, as far as it exists; empty where that cannot be found out.
std::filesystem::path Whole(const std::string& path) {
  std::error_code error;
  const std::filesystem::path whole = std::filesystem::weakly_canonical(std::filesystem::absolute(path, error), error);
  return error ? std::filesystem::path() : whole;
}

/// Whether --out may be written, and as a file that includes the scenario.
void CheckOut(const IdentifyArguments& arguments, const MeasuredCase& measured, Diagnostics& diagnostics) {
  if (arguments.out.empty()) return;
  const SourceSpan where = {"--out"};
  std::ifstream file(arguments.out);
  std::string begin(identification::kIdentified.size(), ' ');
  file.read(begin.data(), static_cast<std::streamsize>(begin.size()));
  const std::filesystem::path out = Whole(arguments.out);
  std::error_code error;
  if (out.empty())
    diagnostics.Error(where, fmt::format("\"{}\" is no place for a file", arguments.out));
  else if (std::filesystem::exists(arguments.out, error) && begin != identification::kIdentified)
    diagnostics.Error(where, fmt::format("\"{}\" is there already, and not from identify", arguments.out),
                      "give another name");
  else if (out == Whole(measured.file))
    diagnostics.Error(where, "is the scenario itself, which the new file includes", "give another name");
  else if (out == Whole(arguments.common.json))
    diagnostics.Error(where, "is where --json goes", "give another name");
  for (const std::string& change : arguments.overrides) {
    const Value* value = measured.plan.root.FindPath(change.substr(0, change.find('=')));
    if (value != nullptr && value->is_table())
      diagnostics.Error({"--set"}, "replaces a table, but the file of --out could only add to it",
                        "set its keys one by one, or write it into a scenario");
  }
}

int Identify(const IdentifyArguments& arguments) {
  Diagnostics diagnostics;
  const std::unique_ptr<Registry> registry = MakeRegistry(arguments.common, diagnostics);
  std::optional<MeasuredCase> measured =
      LoadMeasured(arguments.scenario, arguments.data, arguments.maps, {}, arguments.overrides, *registry, diagnostics);
  if (Report(diagnostics) != kGood || !measured) return kUsage;
  Diagnostics wrong;
  const std::vector<identification::FreeKey> keys = FreeKeys(arguments, *registry, measured->plan, wrong);
  CheckOut(arguments, *measured, wrong);
  if (Report(wrong) != kGood) return kUsage;
  for (const MappedRecord& record : measured->data) {
    for (const std::string& note : record.notes) Note(fmt::format("{}: {}\n", record.file, note));
    std::string why = record.outputs.empty() ? "no output of the scenario is in it: nothing to compare" : "";
    for (const auto& [name, series] : record.outputs) {
      if (why.empty()) why = TooFew(series.values->size());
    }
    if (why.empty()) continue;
    Complain(fmt::format("{}: {}\n", record.file, why));
    return kUndecided;
  }
  const identification::IdentifyOptions options = {keys, arguments.method, arguments.starts,
                                                   [](double done) { ShowProgress("fitting", done); }};
  Result<identification::Identified> result =
      identification::IdentifyBetween(measured->plan, measured->data, *registry, options);
  if (result.ok()) {
    for (std::string& cause : identification::WhatItMayBe(measured->plan, measured->data, *registry, options, *result))
      result->doubts.push_back(std::move(cause));
  }
  ClearProgress();
  if (!result.ok()) {
    Complain(result.failure().ToString() + "\n");
    return result.failure().exit_code;
  }
  Print(arguments.common, identification::ToTable(*result));
  nlohmann::json document = identification::ToJson(*result);
  for (const std::string& note : result->notes) Note(note + "\n");
  for (const std::string& doubt : result->doubts) Complain(doubt + "\n");
  int exit = result->converged == 0 || !result->doubts.empty() ? kUndecided : kGood;
  if (!arguments.out.empty()) {
    const std::filesystem::path out = Whole(arguments.out);
    const std::string include = Whole(measured->file).lexically_relative(out.parent_path()).generic_string();
    Diagnostics known;  // reported when the scenario was loaded
    const std::optional<Plan> written = LoadPlan(measured->file, arguments.overrides, known);
    const std::optional<Plan> included = LoadPlan(measured->file, {}, known);
    Plan applied = *written;
    ApplyEffects(*registry, applied, known);
    std::string records;  // that the numbers were fitted to
    for (const std::string& file : arguments.data) records += fmt::format("# SHA-256 of a record: {}\n", HashOf(file));
    std::string text = identification::ToScenario(*result, applied, *written, *included, include, arguments.overrides);
    text.insert(identification::kIdentified.size(), records);
    if (Status failed = WriteFileAtomically(out, text)) {
      Complain(failed->ToString() + "\n");
      exit = failed->exit_code;
    } else {
      document["scenario"] = arguments.out;
    }
  }
  KeepJson(std::move(document));
  return exit;
}

}  // namespace

void AddIdentify(Command program) {
  std::vector<std::string> methods;
  for (const auto& [name, method] : identification::Methods()) methods.push_back(name);
  auto arguments = std::make_shared<IdentifyArguments>();
  Command command = program.Subcommand("identify", "fit numbers of a scenario to records");
  command.Value("scenario", arguments->scenario, "id or file").Required();
  command.Value("--data", arguments->data, "record (CSV, HDF5, MAT); may be given several times").Required().OneWord();
  command.Value("--map", arguments->maps, "which column is which signal; one for all, or one each").OneWord();
  command.Value("--free", arguments->free, "KEY,...: dotted paths of the numbers to fit")
      .Required()
      .SplitAtCommas()
      .OneWord();
  command.Value("--bound", arguments->bounds, "KEY=LOW:HIGH: starts lie anywhere within; without, a decade around")
      .OneWord();
  command.Value("--method", arguments->method, HelpOfMethods()).OneOf(methods);
  command.Value("--out", arguments->out, "write the scenario with these numbers to this file");
  command.Value("--set", arguments->overrides, "KEY=VALUE: override any key by its dotted path").OneWord();
  command.Value("--starts", arguments->starts, "points to start from").Within(1, 100);
  AddCommon(command, arguments->common);
  command.Examples(
      "  dynoproof identify diagnose/r2r_soft --data record.csv --free "
      "plant.inertia.I5,plant.shaft.k4.stiffness_Nm_per_rad\n"
      "  dynoproof identify diagnose/r2r_soft --data record.csv --free plant.inertia.I4,plant.inertia.I5 "
      "--bound plant.inertia.I4=0.01:10 --bound plant.inertia.I5=0.01:10 --method spectrum --starts 8 "
      "--out found.toml");
  command.Runs([arguments] { return Identify(*arguments); });
}

}  // namespace dynoproof::app
