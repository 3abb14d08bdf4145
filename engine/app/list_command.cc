// dynoproof list, describe, validate
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "app/app.h"
#include "app/examples.h"
#include "experiment/prepare.h"
#include "experiment/record_map.h"
#include "experiment/warnings.h"
#include "scenario/changes.h"
#include "scenario/find.h"
#include "scenario/load.h"

namespace dynoproof::app {
namespace {

std::string TitleOf(const std::string& file) {
  Diagnostics ignored;  // a faulty scenario is listed as well; `validate` says what is wrong with it
  const std::optional<Plan> plan = LoadPlan(file, {}, ignored);
  if (!plan) return "(cannot be read: dynoproof validate " + file + ")";
  const Value* title = plan->root.Find("title");
  return title != nullptr && title->is_string() ? title->string() : "";
}

int List(const Common& common) {
  Diagnostics diagnostics;
  const std::unique_ptr<Registry> registry = MakeRegistry(common, diagnostics);
  const std::vector<std::string> files = FindScenarios("", diagnostics);
  if (Report(diagnostics) != kGood) return kUsage;
  nlohmann::json document;
  std::string text = "scenarios\n";
  for (const std::string& file : files) {
    const std::string id = ScenarioId(file), title = TitleOf(file);
    text += fmt::format("  {:<36} {}\n", id, title);
    document["scenarios"].push_back({{"id", id}, {"title", title}});
  }
  text += "\nplugins\n";
  for (const PluginInfo* plugin : registry->Plugins()) {
    text += fmt::format("  {:<36} {}\n", plugin->kind + "." + plugin->name, plugin->summary);
    document["plugins"].push_back({{"kind", plugin->kind}, {"name", plugin->name}, {"summary", plugin->summary}});
  }
  text += "\neffects\n";
  for (const Effect* effect : registry->Effects()) {
    text += fmt::format("  {:<36} {}\n", effect->info().name, effect->info().law);
    document["effects"].push_back({{"name", effect->info().name}, {"law", effect->info().law}});
  }
  text += "\nchecks\n";
  for (const CheckKind* kind : registry->Checks()) {
    text += fmt::format("  {:<36} {}\n", kind->name, kind->summary);
    document["checks"].push_back({{"kind", kind->name}, {"summary", kind->summary}});
  }
  Print(common, text);
  KeepJson(std::move(document));
  return kGood;
}

std::string ParameterTable(const std::vector<ParamInfo>& parameters) {
  std::string text;
  for (const ParamInfo& one : parameters) {
    text += fmt::format("  {:<28} {:<18} {:<14} {:<16} {:<12} {}\n", one.name, one.type, one.unit, one.range,
                        one.fallback.empty() ? "required" : one.fallback, one.description);
  }
  return text.empty() ? "  none\n" : text;
}

nlohmann::json ToJson(const std::vector<ParamInfo>& parameters) {
  nlohmann::json list = nlohmann::json::array();
  for (const ParamInfo& one : parameters) {
    list.push_back({{"name", one.name},
                    {"type", one.type},
                    {"unit", one.unit},
                    {"range", one.range},
                    {"default", one.fallback.empty() ? nlohmann::json() : nlohmann::json(one.fallback)},
                    {"description", one.description}});
  }
  return list;
}

/// The ports of a component as it is when every number that must be given is 1; null where that makes none: its ports
/// then depend on what is given.
std::unique_ptr<Component> Sample(const Registry& registry, const PluginInfo& plugin) {
  if (plugin.kind == "law") return nullptr;
  Value table{{"type", plugin.name}};
  for (const ParamInfo& one : plugin.parameters) {
    if (one.fallback.empty() && one.type == "number") table[one.name] = Value(1.0);
    if (one.fallback.empty() && one.type == "integer") table[one.name] = Value(std::int64_t{1});
  }
  Diagnostics ignored;
  BuildContext context{registry, ignored, plugin.name, {}};
  std::unique_ptr<Component> component = registry.MakeComponent(plugin.kind, table, context);
  return ignored.has_errors() ? nullptr : std::move(component);
}

/// Inputs, outputs and states of a plugin with their units.
std::string DescribePorts(const Registry& registry, const PluginInfo& plugin, nlohmann::json& ports) {
  if (plugin.kind == "law") {
    return "ports\n  in     twist, rate         of the two nodes it joins\n  out    torque              on both\n";
  }
  if (plugin.kind == "source") return "ports\n  out    out                 in the unit of the input it drives\n";
  const std::unique_ptr<Component> component = Sample(registry, plugin);
  if (component == nullptr) {
    return "ports\n  they depend on the parameters: `dynoproof describe SCENARIO` lists those of a scenario\n";
  }
  std::string text = "ports\n";
  const Layout& layout = component->layout();
  for (const auto& [what, list] :
       {std::pair("in", &layout.inputs), std::pair("out", &layout.outputs), std::pair("state", &layout.states)}) {
    ports[what] = nlohmann::json::array();
    for (const Port& port : *list) {
      text += fmt::format("  {:<6} {:<19} {}\n", what, port.name, port.unit);
      ports[what].push_back({{"name", port.name}, {"unit", port.unit}});
    }
  }
  return text;
}

/// Lines set in below a heading.
std::string Indented(const std::string& heading, const std::string& lines) {
  std::string text = heading + "\n  ";
  for (std::size_t i = 0; i < lines.size(); ++i) {
    text += lines[i];
    if (lines[i] == '\n' && i + 1 < lines.size()) text += "  ";
  }
  return text;
}

/// Plugins and check kinds of that name ("chirp" or "source.chirp"), as text and JSON; empty when there are none.
std::string DescribePlugins(const Registry& registry, const std::string& name, nlohmann::json& document) {
  std::string text;
  for (const PluginInfo* plugin : registry.Plugins()) {
    const std::string full = plugin->kind + "." + plugin->name;
    if (name != plugin->name && name != full) continue;
    nlohmann::json ports = nlohmann::json::object();
    text += fmt::format("{}: {}\n\nlaw     {}\nsource  {}\n\nparameters (type, unit, range, default)\n{}\n{}\n", full,
                        plugin->summary, plugin->law, plugin->source, ParameterTable(plugin->parameters),
                        DescribePorts(registry, *plugin, ports));
    document["plugins"].push_back({{"kind", plugin->kind},
                                   {"name", plugin->name},
                                   {"summary", plugin->summary},
                                   {"law", plugin->law},
                                   {"source", plugin->source},
                                   {"parameters", ToJson(plugin->parameters)},
                                   {"ports", ports}});
    if (plugin->kind != "law") continue;
    const std::string example = ExampleOf(*plugin);
    text += Indented("in a scenario, e.g. that of `dynoproof new scenario`", example);
    document["plugins"].back()["example"] = example;
  }
  for (const CheckKind* kind : registry.Checks()) {
    if (name != kind->name && name != "check." + kind->name) continue;
    text += fmt::format("check.{}: {}\n\nparameters (type, unit, range, default)\n{}\n", kind->name, kind->summary,
                        ParameterTable(kind->parameters));
    document["checks"].push_back(
        {{"kind", kind->name}, {"summary", kind->summary}, {"parameters", ToJson(kind->parameters)}});
  }
  return text;
}

std::string DescribeEffect(const EffectInfo& info, nlohmann::json& document) {
  std::string text = fmt::format("effect {}: {}\n\nlaw     {}\n\nparameters (unit, bounds, neutral)\n", info.name,
                                 info.description, info.law);
  nlohmann::json parameters = nlohmann::json::array();
  for (const EffectParameter& one : info.parameters) {
    text += fmt::format("  {:<14} {:<14} {:>10g} ... {:<10g} {:<10} {}\n", one.name, one.unit, one.lower, one.upper,
                        std::isnan(one.neutral) ? "" : fmt::format("{:g}", one.neutral), one.description);
    parameters.push_back({{"name", one.name},
                          {"unit", one.unit},
                          {"lower", one.lower},
                          {"upper", one.upper},
                          {"start", one.start},
                          {"description", one.description}});
  }
  document["effects"].push_back({{"name", info.name}, {"law", info.law}, {"parameters", parameters}});
  document["effects"].back()["example"] = ExampleOf(info);
  return text + Indented("\nin a scenario", ExampleOf(info));
}

std::string DescribeScenario(const Registry& registry, const std::string& file, Diagnostics& diagnostics,
                             nlohmann::json& document) {
  const std::unique_ptr<Prepared> prepared = Prepare(file, {}, registry, diagnostics);
  if (prepared == nullptr) return "";
  const Value* source = prepared->plan.root.Find("source");
  std::string text =
      fmt::format("scenario {}: {}\nsource   {}\nfile     {}\n\ninputs\n", prepared->plan.id, prepared->title,
                  source != nullptr && source->is_string() ? source->string() : "", file);
  for (const InputLine& line : prepared->rig->inputs)
    text += fmt::format("  {:<20} {:<10} {}\n", line.name, line.unit, line.description);
  text += "\noutputs\n";
  for (const OutputLine& line : prepared->rig->outputs)
    text += fmt::format("  {:<20} {:<10} {}\n", line.name, line.unit, line.description);
  text += "\nsignals that an output may show\n";
  for (const Block& block : prepared->rig->blocks) {
    for (const Port& port : block.component->layout().outputs)
      text += fmt::format("  {}.{} [{}]\n", block.name, port.name, port.unit);
  }
  const std::vector<std::string> values = StatedValues(prepared->plan.root);
  text += "\nvalues, as --set takes them\n";
  for (const std::string& value : values) text += "  " + value + "\n";
  text += "\nplaces of effects\n";
  nlohmann::json places = nlohmann::json::object();
  for (const Effect* effect : registry.Effects()) {
    std::vector<std::string> names;
    for (const Place& place : effect->Places(prepared->plan)) names.push_back(place.ToString());
    if (!names.empty()) text += fmt::format("  {:<22} {}\n", effect->info().name, fmt::join(names, ", "));
    places[effect->info().name] = names;
  }
  const auto lines = [](const auto& list) {
    nlohmann::json json = nlohmann::json::array();
    for (const auto& line : list) {
      json.push_back({{"name", line.name}, {"unit", line.unit}, {"description", line.description}});
    }
    return json;
  };
  document["scenarios"].push_back({{"id", prepared->plan.id},
                                   {"title", prepared->title},
                                   {"inputs", lines(prepared->rig->inputs)},
                                   {"outputs", lines(prepared->rig->outputs)},
                                   {"values", values},
                                   {"places", places}});
  return text;
}

int Describe(const Common& common, const std::string& name) {
  Diagnostics diagnostics;
  const std::unique_ptr<Registry> registry = MakeRegistry(common, diagnostics);
  nlohmann::json document = nlohmann::json::object();
  std::string text = DescribePlugins(*registry, name, document);
  if (name == "map") text += DescribeRecordMap();
  if (const Effect* effect = registry->FindEffect(name)) text += DescribeEffect(effect->info(), document);
  if (text.empty()) {
    Diagnostics search;
    const std::vector<std::string> files = FindScenarios(name, search);
    if (files.size() == 1) {
      text = DescribeScenario(*registry, files[0], diagnostics, document);
    } else {
      std::vector<std::string> names;
      for (const PluginInfo* plugin : registry->Plugins()) names.push_back(plugin->name);
      for (const Effect* effect : registry->Effects()) names.push_back(effect->info().name);
      const std::optional<std::string> near = Closest(name, names);
      diagnostics.Error({name}, "is no plugin, effect, check or scenario",
                        near ? fmt::format("did you mean \"{}\"?", *near) : "see: dynoproof list");
    }
  }
  if (Report(diagnostics) != kGood) return kUsage;
  Print(common, text);
  KeepJson(std::move(document));
  return kGood;
}

int Validate(const Common& common, const std::vector<std::string>& names) {
  nlohmann::json document = {{"files", nlohmann::json::array()}};
  Diagnostics all;
  const std::unique_ptr<Registry> registry = MakeRegistry(common, all);
  for (const std::string& name : names) {
    for (const std::string& file : FindScenarios(name, all)) {
      Diagnostics own;
      if (const std::unique_ptr<Prepared> prepared = Prepare(file, {}, *registry, own)) {
        ChecksApply(prepared->checks, prepared->plan, *prepared->rig, own);
        AddWarnings(*prepared, own);
        // What drives the scenario is a part of it; `run` would fail.
        const Value* record = prepared->plan.root.FindPath("record.file");
        if (record != nullptr && !prepared->record_fault.empty()) own.Error(record->where(), prepared->record_fault);
      }
      nlohmann::json faults = nlohmann::json::array();
      for (const Diagnostic& item : own.items()) {
        faults.push_back(AsJson(item));
      }
      document["files"].push_back({{"file", file}, {"valid", !own.has_errors()}, {"diagnostics", faults}});
      if (!own.has_errors()) Print(common, fmt::format("{}: valid\n", file));
      all.Append(own);
    }
  }
  KeepJson(std::move(document));
  return Report(all);
}

}  // namespace

void AddList(Command program) {
  auto common = std::make_shared<Common>();
  Command command = program.Subcommand("list", "scenarios, plugins, effects, checks, with a line each");
  AddCommon(command, *common);
  command.Examples("  dynoproof list\n  dynoproof list --json -");
  command.Runs([common] { return List(*common); });
}

void AddDescribe(Command program) {
  struct Arguments {
    Common common;
    std::string name;
  };
  auto arguments = std::make_shared<Arguments>();
  Command command = program.Subcommand(
      "describe",
      "a plugin, effect, check or scenario: law, parameters, ports, source; or `map`: the keys of a map file");
  command.Value("name", arguments->name, "its name").Required();
  AddCommon(command, arguments->common);
  command.Examples(
      "  dynoproof describe drive_line\n  dynoproof describe coulomb_friction\n  dynoproof describe "
      "r2r/soft_rotor_setup_1\n  dynoproof describe map");
  command.Runs([arguments] { return Describe(arguments->common, arguments->name); });
}

void AddValidate(Command program) {
  struct Arguments {
    Common common;
    std::vector<std::string> files;
  };
  auto arguments = std::make_shared<Arguments>();
  Command command = program.Subcommand("validate", "every fault of every file: file:line:column, with a suggestion");
  command.Value("files", arguments->files, "files, ids or folders").Required();
  AddCommon(command, arguments->common);
  command.Examples("  dynoproof validate my_line.toml\n  dynoproof validate scenarios/");
  command.Runs([arguments] { return Validate(arguments->common, arguments->files); });
}

}  // namespace dynoproof::app
