#include "model/plan.h"

#include <fmt/format.h>

#include <algorithm>

#include "model/section.h"

namespace dynoproof {
namespace {

const std::vector<std::string> kTopLevel = {"title",  "source",  "include",   "run",     "plant",
                                            "part",   "control", "input",     "output",  "analysis",
                                            "check",  "effect",  "record",    "variant", "prediction_window_s",
                                            "budget", "without", "extension", "format",  "prior"};

template <class Spec>
std::vector<std::pair<std::string, Spec>> ReadNamed(const Plan& plan, const char* section, Diagnostics& diagnostics) {
  std::vector<std::pair<std::string, Spec>> specs;
  const Value* tables = plan.root.Find(section);
  if (tables == nullptr) return specs;
  if (!tables->is_table()) {
    diagnostics.Error(tables->where(), fmt::format("\"{}\" is {}", section, tables->KindName()),
                      fmt::format("write [{}.NAME]", section));
    return specs;
  }
  for (const Value::Entry& entry : tables->table()) {
    Spec spec;
    const std::string context = fmt::format("{}.{}", section, entry.key);
    if (!entry.value.is_table()) {
      diagnostics.Error(entry.value.where(), fmt::format("{} is {}", context, entry.value.KindName()),
                        fmt::format("write [{}]", context));
    } else if (ReadParams(entry.value, spec, diagnostics, context)) {
      specs.emplace_back(entry.key, std::move(spec));
    }
  }
  return specs;
}

}  // namespace

RunSettings ReadRun(const Plan& plan, Diagnostics& diagnostics) {
  RunSettings settings;
  const Value* run = plan.root.Find("run");
  if (run == nullptr || !run->is_table()) {
    diagnostics.Error(run != nullptr ? run->where() : plan.root.where(),
                      run != nullptr ? "\"run\" is " + run->KindName() : "the scenario has no section [run]",
                      "add [run] with duration_s = ...");
    return settings;
  }
  if (!ReadParams(*run, settings, diagnostics, "run", {"reference", "realtime"})) return settings;
  const Value empty;
  const auto section = [run, &empty](const char* key) { return run->Find(key) != nullptr ? run->Find(key) : &empty; };
  ReadParams(*section("reference"), settings.reference, diagnostics, "run.reference");
  ReadParams(*section("realtime"), settings.realtime, diagnostics, "run.realtime");
  Faults faults(*run, diagnostics, "run");
  const auto period = ToNanoseconds(settings.period_s);
  const auto duration = ToNanoseconds(settings.duration_s);
  if (!period || *period < 1000) {
    faults.At("period_s", fmt::format("the clock cannot keep a period of {} s", settings.period_s),
              "whole nanoseconds, at least 1e-6 s");
  } else if (!duration || *duration % *period != 0) {
    faults.At("duration_s",
              fmt::format("{} s is no whole number of periods of {} s", settings.duration_s, settings.period_s),
              "let the rates divide");
  } else if (*duration / *period > 200'000'000) {
    faults.At("duration_s", fmt::format("{} samples are more than a trace can hold", *duration / *period),
              "at most 2e8 samples: a shorter duration or a longer period_s");
  }
  return settings;
}

int SubstepsOf(const Plan& plan) {
  const Value* written = plan.root.FindPath("run.realtime.substeps");
  const bool given = written != nullptr && written->is_integer();
  return given ? static_cast<int>(written->integer()) : RunSettings::Realtime().substeps;
}

void SetSubsteps(Plan& plan, int substeps) { plan.root["run"]["realtime"]["substeps"] = Value(std::int64_t{substeps}); }

std::vector<std::pair<std::string, InputSpec>> ReadInputs(const Plan& plan, Diagnostics& diagnostics) {
  return ReadNamed<InputSpec>(plan, "input", diagnostics);
}

std::vector<std::pair<std::string, OutputSpec>> ReadOutputs(const Plan& plan, Diagnostics& diagnostics) {
  return ReadNamed<OutputSpec>(plan, "output", diagnostics);
}

std::vector<EffectUse> ReadEffects(const Plan& plan, Diagnostics& diagnostics) {
  std::vector<EffectUse> uses;
  const Value* effects = plan.root.Find("effect");
  if (effects == nullptr) return uses;
  if (!effects->is_array()) {
    diagnostics.Error(effects->where(), "\"effect\" is " + effects->KindName(), "write [[effect]]");
    return uses;
  }
  for (const Value& table : effects->array()) {
    EffectUse use;
    use.where = table.where();
    if (!table.is_table()) {
      diagnostics.Error(table.where(), "an effect is " + table.KindName(), "write [[effect]]");
    } else if (ReadParams(table, use, diagnostics, "effect")) {
      use.name_where = table.Find("name")->where();
      use.at_where = table.Find("at")->where();
      uses.push_back(std::move(use));
    }
  }
  return uses;
}

void ExtensionSpec::Check(Faults& faults) const {
  if (of.empty()) faults.At("of", "\"of\" names no scenario", "write the id of the nominal scenario, or its file");
  for (const std::string& change : set) {
    if (const std::size_t equals = change.find('='); equals == std::string::npos || equals == 0)
      faults.At("set", fmt::format("\"{}\" is no override", change), "write set = [\"path.to.key=value\"]");
  }
}

std::optional<ExtensionSpec> ReadExtension(const Plan& plan, Diagnostics& diagnostics) {
  const Value* table = SectionTable(plan, "extension", "write [extension] with of = \"...\"", diagnostics);
  ExtensionSpec spec;
  if (table == nullptr || !ReadParams(*table, spec, diagnostics, "extension", {"start"})) return std::nullopt;
  return spec;
}

void CheckTopLevel(const Plan& plan, Diagnostics& diagnostics) {
  for (const Value::Entry& entry : plan.root.table()) {
    const bool text = entry.key == "title" || entry.key == "source";
    if (text && !entry.value.is_string()) {
      diagnostics.Error(entry.value.where(), fmt::format("\"{}\" is {}", entry.key, entry.value.KindName()),
                        "write a string");
    }
    if (std::find(kTopLevel.begin(), kTopLevel.end(), entry.key) != kTopLevel.end()) continue;
    const std::optional<std::string> near = Closest(entry.key, kTopLevel);
    diagnostics.Error(
        entry.where, fmt::format("unknown section \"{}\"", entry.key),
        near ? fmt::format("did you mean \"{}\"?", *near) : fmt::format("known: {}", fmt::join(kTopLevel, ", ")));
  }
}

}  // namespace dynoproof
