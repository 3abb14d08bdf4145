// dynoproof reduce
#include <fmt/format.h>

#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "app/app.h"
#include "app/interruption.h"
#include "app/one_scenario.h"
#include "app/scratch.h"
#include "base/process.h"
#include "base/text.h"
#include "experiment/golden.h"
#include "experiment/run_scenario.h"
#include "reduce/reduce.h"
#include "scenario/load.h"

namespace dynoproof::app {
namespace {

namespace fs = std::filesystem;

struct ReduceArguments {
  Common common;
  std::string scenario, check, out = "reduced.toml", sound;
  std::vector<std::string> overrides;
  int most_runs = 100;
};

/// Files that the scenario names as seen from its folder are named as seen from another one.
void MoveFiles(Value& value, const fs::path& from, const fs::path& to) {
  if (value.is_array()) {
    for (Value& item : value.array()) MoveFiles(item, from, to);
  }
  if (!value.is_table()) return;
  for (Value::Entry& entry : value.table()) {
    const bool file = entry.key == "file" || entry.key == "map";
    if (file && entry.value.is_string() && !fs::path(entry.value.string()).is_absolute())
      entry.value = Value(fs::proximate(from / entry.value.string(), to).string());
    MoveFiles(entry.value, from, to);
  }
}

/// The golden trace of the blessed scenario with the same taken out, and what the other solver makes of it.
int WriteReducedGolden(const reduce::Reduced& reduced, const std::string& of, const GoldenPlace& place,
                       const Registry& registry) {
  Diagnostics diagnostics;
  PrepareOptions other;
  other.solver = reduced.before->root.TextOr("run.solver", "realtime") == "reference" ? "realtime" : "reference";
  const auto own = Prepare(*reduced.before, {}, registry, diagnostics);
  const auto others = Prepare(*reduced.before, other, registry, diagnostics);
  if (own == nullptr || others == nullptr) return Report(diagnostics);
  const Result<Course> course = Play(*own), beside = Play(*others);
  for (const Result<Course>* one : {&course, &beside}) {
    if (one->ok()) continue;
    Complain(one->failure().ToString() + "\n");
    return kBroken;
  }
  const Status failed = WriteGolden(place, {course->trace, beside->trace, StatedChecks(reduced.plan),
                                            fmt::format("what is left of {} as it was blessed", of)});
  if (failed) Complain(failed->ToString() + "\n");
  return failed ? kBroken : kGood;
}

/// The golden data beside the reduced scenario: the run of the one that was blessed, with the same taken out and the tolerances that
/// it had; or, where only time was taken out, those that there were. Made elsewhere, so that nothing half has a final name.
int WriteGoldenBeside(const reduce::Reduced& reduced, const Plan& scenario, const std::string& out,
                      const Scratch& scratch, const Registry& registry) {
  if (reduced.first.stated != GoldenCheck::kName) return kGood;
  Plan there = reduced.plan;
  there.id = fs::path(out).stem().string();
  there.file = out;
  const GoldenPlace to = GoldenPlaceOf(there);
  GoldenPlace from = GoldenPlaceOf(scenario);
  if (reduced.before) {
    there.file = (scratch.folder() / fs::path(out).filename()).string();
    const GoldenPlace made = GoldenPlaceOf(there);
    if (const auto bytes = ReadTextFile(from.tolerances); bytes && WriteText(made.tolerances, *bytes) != kGood)
      return kBroken;
    if (const int written = WriteReducedGolden(reduced, scenario.id, made, registry); written != kGood) return written;
    from = made;
  }
  for (const auto& [a, b] : {std::pair(from.trace, to.trace), std::pair(from.tolerances, to.tolerances)}) {
    const auto bytes = ReadTextFile(a);
    if (bytes && WriteText(b, *bytes) != kGood) return kBroken;
  }
  return kGood;
}

std::string ShownBy(const score::Check& check) {
  if (check.name.empty()) return "the run breaks";
  if (!std::isfinite(check.value)) return check.name + ": " + check.explanation;
  return fmt::format("{}: {:.3g}, {} {:.3g}", check.name, check.value, check.at_least ? "at least" : "limit",
                     check.limit);
}

/// Whether a program passes the check of a plan: it runs a file of it in a folder of its own. A run that breaks passes nothing.
bool PassesWith(const std::string& program, const Plan& plan, const std::string& check, const Scratch& scratch) {
  Value root = plan.root;
  MoveFiles(root, fs::absolute(plan.file).parent_path(), scratch.folder());
  const std::string file = (scratch.folder() / "tried.toml").string(),
                    json = (scratch.folder() / "tried.json").string();
  if (WriteText(file, ToToml(root)) != kGood) return false;
  std::error_code error;
  fs::remove(json, error);
  RunProgram({program, "run", file, "--out", (scratch.folder() / "out").string(), "--json", json},
             ErrorLines::kDropped);
  const auto document = nlohmann::json::parse(ReadTextFile(json).value_or(""), nullptr, false);
  if (!document.is_object() || document.value("scenarios", nlohmann::json::array()).size() != 1) return false;
  const nlohmann::json& scenario = document["scenarios"][0];
  if (scenario.value("verdict", "") == "broken") return false;
  if (check.empty()) return true;  // a run that breaks here, and not there
  for (const nlohmann::json& one : scenario.value("checks", nlohmann::json::array())) {
    if (one.value("name", "") == check) return one.value("verdict", "") == "pass";
  }
  return false;
}

int Reduce(const ReduceArguments& arguments) {
  Diagnostics diagnostics;
  const std::unique_ptr<Registry> registry = MakeRegistry(arguments.common, diagnostics);
  const std::optional<std::string> file = OneScenario(arguments.scenario, diagnostics);
  std::optional<Plan> plan;
  if (file) plan = LoadPlan(*file, arguments.overrides, diagnostics);
  if (Report(diagnostics) != kGood || !plan) return kUsage;
  if (!CanWrite({arguments.out, arguments.common.json})) return kBroken;
  std::error_code error;
  if (fs::equivalent(arguments.out, *file, error)) {
    Complain(arguments.out + ": is the scenario itself; --out names another file\n");
    return kUsage;
  }
  const Interruption interruption(arguments.common, [] { return std::string("nothing was written"); });
  reduce::Options options{.check = arguments.check, .most_runs = arguments.most_runs};
  const Scratch scratch("reduce");
  if (!scratch.ok()) return kBroken;
  if (!arguments.sound.empty())
    options.sound = [&](const Plan& tried, const std::string& check) {
      return PassesWith(arguments.sound, tried, check, scratch);
    };
  options.progress = [&](const std::string& what, int runs) {
    ShowProgress(fmt::format("run {}: without {}", runs, what),
                 static_cast<double>(runs) / static_cast<double>(arguments.most_runs));
  };
  Result<reduce::Reduced> reduced = reduce::Reduce(*plan, *registry, options);
  ClearProgress();
  if (!reduced.ok()) {
    Complain(reduced.failure().ToString() + "\n");
    return reduced.failure().exit_code;
  }
  const fs::path folder = fs::absolute(arguments.out).parent_path();
  MoveFiles(reduced->plan.root, fs::absolute(*file).parent_path(), folder);
  const std::string again = fmt::format("dynoproof run {}", ShellQuoted(arguments.out));
  const std::string head =
      fmt::format("# What is left of {} that still fails \"{}\": {}\n", plan->id, reduced->check, again);
  // The scenario last: what it is compared with is there by then.
  if (const int golden = WriteGoldenBeside(*reduced, *plan, arguments.out, scratch, *registry); golden != kGood)
    return golden;
  if (const int written = WriteText(arguments.out, head + ToToml(reduced->plan.root)); written != kGood) return written;

  const std::size_t lines = reduced->steps.empty() ? reduced->lines_before : reduced->steps.back().lines;
  const double seconds = reduced->plan.root.NumberOr("run.duration_s", reduced->seconds_before);
  std::string text = fmt::format("{}: {} of {} lines and {:.3g} of {:.3g} s still fail \"{}\"\n", plan->id, lines,
                                 reduced->lines_before, seconds, reduced->seconds_before, reduced->check);
  text += fmt::format("  before  {}\n  now     {}\n\n{:>7}{:>11}  taken out\n", ShownBy(reduced->first),
                      ShownBy(reduced->last), "lines", "s");
  nlohmann::json steps = nlohmann::json::array();
  for (const reduce::Step& step : reduced->steps) {
    text += fmt::format("{:>7}{:>11.3g}  {}\n", step.lines, step.seconds, step.what);
    steps.push_back({{"taken_out", step.what}, {"lines", step.lines}, {"seconds", step.seconds}});
  }
  text += fmt::format("\n{} runs{}; {}\n", reduced->runs,
                      reduced->complete ? "" : ", and more would take more out: --most-runs", again);
  Print(arguments.common, text);
  KeepJson({{"id", plan->id},
            {"check", reduced->check},
            {"scenario", arguments.out},
            {"lines", {{"before", reduced->lines_before}, {"after", lines}}},
            {"seconds", {{"before", reduced->seconds_before}, {"after", seconds}}},
            {"runs", reduced->runs},
            {"complete", reduced->complete},
            {"steps", steps}});
  return kGood;
}

}  // namespace

void AddReduce(CLI::App& program, int& exit) {
  auto arguments = std::make_shared<ReduceArguments>();
  CLI::App* command = program.add_subcommand("reduce", "the smallest scenario that still fails the same check");
  command->add_option("scenario", arguments->scenario, "id or file")->required();
  command->add_option("--check", arguments->check, "name of the failing check, or its kind (default: the worst)");
  command->add_option("--set", arguments->overrides, "KEY=VALUE: override any key by its dotted path")
      ->allow_extra_args(false);
  command->add_option(
      "--sound", arguments->sound,
      "a program that passes the check, as the last release: it must pass what is left, too (no golden check)");
  command->add_option("--out", arguments->out, "the scenario that is left (default reduced.toml)")->check(NamesFile());
  command->add_option("--most-runs", arguments->most_runs, "what is left after so many runs stands (default 100)")
      ->check(CLI::Range(1, 100000));
  AddCommon(*command, arguments->common);
  AddExamples(*command,
              "  dynoproof reduce line.toml\n"
              "  dynoproof reduce line.toml --sound /usr/bin/dynoproof\n"
              "  dynoproof reduce backlash/clamped --check \"solvers T_shaft\" --out small.toml");
  command->callback([arguments, &exit] { exit = Reduce(*arguments); });
}

}  // namespace dynoproof::app
