// dynoproof reduce
#include <fmt/format.h>

#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "app/app.h"
#include "app/interruption.h"
#include "app/one_scenario.h"
#include "app/reduce_record.h"
#include "app/scratch.h"
#include "base/process.h"
#include "base/text.h"
#include "experiment/golden.h"
#include "experiment/run_scenario.h"
#include "reduce/reduce.h"
#include "reduce/short_form.h"
#include "reduce/symptom.h"
#include "scenario/load.h"
#include "trace/trace_io.h"

namespace dynoproof::app {
namespace {

namespace fs = std::filesystem;

struct ReduceArguments {
  Common common;
  std::string scenario, check, out, sound, data, map;
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

/// Another build of this program, which runs a plan as a file in a folder of its own.
class OtherProgram {
 public:
  OtherProgram(std::string program, const Scratch& scratch) : program_(std::move(program)), folder_(scratch.folder()) {}

  /// Whether it passes the check of the plan; without a name, whether its run ends. A run that breaks passes nothing.
  bool Passes(const Plan& plan, const std::string& check) const {
    const nlohmann::json scenario = Run(plan, "");
    if (!scenario.is_object() || scenario.value("verdict", "") == "broken") return false;
    if (check.empty()) return true;  // a run that breaks here, and not there
    // Numbers in a name may have moved along with what is left: it counts as it is first, and without them where it is not there.
    bool like_it = false;
    for (const nlohmann::json& one : scenario.value("checks", nlohmann::json::array())) {
      const bool pass = one.value("verdict", "") == "pass";
      if (one.value("name", "") == check) return pass;
      like_it = like_it || (pass && reduce::WithoutNumbers(one.value("name", "")) == reduce::WithoutNumbers(check));
    }
    return like_it;
  }

  std::optional<trace::Trace> TraceOf(const Plan& plan, const std::string& solver = "") const {
    const nlohmann::json scenario = Run(plan, solver);
    if (!scenario.is_object() || scenario.value("trace", "").empty()) return std::nullopt;
    Result<trace::Trace> trace = trace::ReadTrace(scenario.value("trace", ""));
    return trace.ok() ? std::optional(*std::move(trace)) : std::nullopt;
  }

 private:
  nlohmann::json Run(const Plan& plan, const std::string& solver) const {
    Value root = plan.root;
    MoveFiles(root, fs::absolute(plan.file).parent_path(), folder_);
    const std::string file = (folder_ / "tried.toml").string(), json = (folder_ / "tried.json").string();
    if (WriteText(file, ToToml(root)) != kGood) return nullptr;
    std::error_code error;
    fs::remove(json, error);
    std::vector<std::string> words = {program_, "run", file, "--out", (folder_ / "out").string(), "--json", json};
    if (!solver.empty()) words.insert(words.end(), {"--solver", solver});
    RunProgram(words, ErrorLines::kDropped);
    const auto document = nlohmann::json::parse(ReadTextFile(json).value_or(""), nullptr, false);
    if (!document.is_object() || document.value("scenarios", nlohmann::json::array()).size() != 1) return nullptr;
    return document["scenarios"][0];
  }

  std::string program_;
  fs::path folder_;
};

/// The run that a reduced golden check compares with, and what the other solver makes of it: of the blessed scenario with the same
/// taken out, or the other program's.
int WriteReducedGolden(const reduce::Reduced& reduced, const std::string& of, const GoldenPlace& place,
                       const Registry& registry, const OtherProgram& sound) {
  const Plan& plan = reduced.before ? *reduced.before : reduced.plan;
  const std::string other = plan.root.TextOr("run.solver", "realtime") == "reference" ? "realtime" : "reference";
  std::vector<trace::Trace> traces;
  for (const std::string& solver : {std::string(), other}) {
    if (reduced.beside_sound) {
      std::optional<trace::Trace> trace = sound.TraceOf(plan, solver);
      if (!trace) {
        Complain("the other program gives no trace of what is left\n");
        return kBroken;
      }
      traces.push_back(*std::move(trace));
      continue;
    }
    Diagnostics diagnostics;
    PrepareOptions options;
    options.solver = solver;
    const auto prepared = Prepare(plan, options, registry, diagnostics);
    if (prepared == nullptr) return Report(diagnostics);
    Result<Course> course = Play(*prepared);
    if (!course.ok()) {
      Complain(course.failure().ToString() + "\n");
      return kBroken;
    }
    traces.push_back(std::move(course->trace));
  }
  const Status failed =
      WriteGolden(place, {traces[0], traces[1], StatedChecks(reduced.plan),
                          reduced.beside_sound ? fmt::format("what is left of {} by the other program", of)
                                               : fmt::format("what is left of {} as it was blessed", of)});
  if (failed) Complain(failed->ToString() + "\n");
  return failed ? kBroken : kGood;
}

/// The golden data beside the reduced scenario: the run of the one that was blessed, with the same taken out and the tolerances that
/// it had; or, where only time was taken out, those that there were. Made elsewhere, so that nothing half has a final name.
int WriteGoldenBeside(const reduce::Reduced& reduced, const Plan& scenario, const std::string& out,
                      const Scratch& scratch, const Registry& registry, const OtherProgram& sound) {
  if (reduced.first.stated != GoldenCheck::kName) return kGood;
  Plan there = reduced.plan;
  there.id = fs::path(out).stem().string();
  there.file = out;
  const GoldenPlace to = GoldenPlaceOf(there);
  GoldenPlace from = GoldenPlaceOf(scenario);
  if (reduced.before || reduced.beside_sound) {
    there.file = (scratch.folder() / fs::path(out).filename()).string();
    const GoldenPlace made = GoldenPlaceOf(there);
    if (const auto bytes = ReadTextFile(from.tolerances); bytes && WriteText(made.tolerances, *bytes) != kGood)
      return kBroken;
    if (const int written = WriteReducedGolden(reduced, scenario.id, made, registry, sound); written != kGood)
      return written;
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

int Reduce(const ReduceArguments& arguments) {
  Diagnostics diagnostics;
  const std::unique_ptr<Registry> registry = MakeRegistry(arguments.common, diagnostics);
  const std::optional<std::string> file = OneScenario(arguments.scenario, diagnostics);
  std::optional<Plan> plan;
  if (file) plan = LoadPlan(*file, arguments.overrides, diagnostics);
  std::optional<Plan> good;
  if (file && !arguments.overrides.empty()) good = LoadPlan(*file, {}, diagnostics);
  // What `run` would refuse has no failing check.
  if (const auto prepared = plan ? Prepare(*plan, {}, *registry, diagnostics) : nullptr; prepared != nullptr)
    ChecksApply(prepared->checks, prepared->plan, *prepared->rig, diagnostics);
  if (Report(diagnostics) != kGood || !plan) return kUsage;
  if (!CanWrite({arguments.out, arguments.common.json})) return kBroken;
  std::error_code error;
  if (fs::equivalent(arguments.out, *file, error)) {
    Complain(arguments.out + ": is the scenario itself; --out names another file\n");
    return kUsage;
  }
  const Interruption interruption(arguments.common, [] { return std::string("nothing was written"); });
  reduce::Options options{.check = arguments.check, .good = std::move(good), .most_runs = arguments.most_runs};
  const Scratch scratch("reduce");
  if (!scratch.ok()) return kBroken;
  const OtherProgram sound(arguments.sound, scratch);
  if (!arguments.sound.empty()) {
    options.sound = [&](const Plan& tried, const std::string& check) { return sound.Passes(tried, check); };
    options.sound_trace = [&](const Plan& tried) { return sound.TraceOf(tried); };
  }
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
  if (const int golden = WriteGoldenBeside(*reduced, *plan, arguments.out, scratch, *registry, sound); golden != kGood)
    return golden;
  const std::string left = reduce::ShortForm(reduced->plan.root);
  if (const int written = WriteText(arguments.out, head + left); written != kGood) return written;

  const std::size_t lines = reduce::LinesOf(left), values = reduce::ValuesOf(reduced->plan.root);
  const double seconds = reduced->plan.root.NumberOr("run.duration_s", reduced->seconds_before);
  std::string text = fmt::format("{}: {} of {} lines, {} of {} values and {:.3g} of {:.3g} s still fail \"{}\"\n",
                                 plan->id, lines, reduced->lines_before, values, reduced->values_before, seconds,
                                 reduced->seconds_before, reduced->check);
  text += fmt::format("  before  {}\n  now     {}\n\n{:>7}{:>11}  taken out\n", ShownBy(reduced->first),
                      ShownBy(reduced->last), "lines", "s");
  nlohmann::json steps = nlohmann::json::array();
  for (const reduce::Step& step : reduced->steps) {
    text += fmt::format("{:>7}{:>11.3g}  {}\n", step.lines, step.seconds, step.what);
    steps.push_back({{"taken_out", step.what}, {"lines", step.lines}, {"seconds", step.seconds}});
  }
  text += fmt::format("{:>7}{:>11.3g}  what fits on a line stands on one\n", lines, seconds);
  text += fmt::format("\n{} runs{}; {}\n", reduced->runs,
                      reduced->complete ? "" : ", and more would take more out: --most-runs", again);
  Print(arguments.common, text);
  KeepJson({{"id", plan->id},
            {"check", reduced->check},
            {"scenario", arguments.out},
            {"lines", {{"before", reduced->lines_before}, {"after", lines}}},
            {"values", {{"before", reduced->values_before}, {"after", values}}},
            {"seconds", {{"before", reduced->seconds_before}, {"after", seconds}}},
            {"runs", reduced->runs},
            {"complete", reduced->complete},
            {"steps", steps}});
  return kGood;
}

}  // namespace

void AddReduce(Command program) {
  auto arguments = std::make_shared<ReduceArguments>();
  Command command = program.Subcommand("reduce", "the smallest scenario that still fails the same check");
  command.Value("scenario", arguments->scenario, "id or file").Required();
  command.Value("--check", arguments->check, "name of the failing check, or its kind (default: the worst)");
  command.Value("--set", arguments->overrides, "KEY=VALUE: override any key by its dotted path").OneWord();
  command.Value("--sound", arguments->sound,
                "a program that passes the check, as the last release: it must pass what is left, too");
  const Option data = command.Value("--data", arguments->data,
                                    "a record with which `run --data` falls short or of which `check-data` says "
                                    "a fault: its shortest cut that still does");
  command.Value("--map", arguments->map, "which column of --data is which signal (TOML)").Needs(data);
  command.Value("--out", arguments->out, "what is left (default reduced.toml, with --data reduced.csv)").NamesFile();
  command.Value("--most-runs", arguments->most_runs, "what is left after so many runs stands (default 100)")
      .Within(1, 100000);
  AddCommon(command, arguments->common);
  command.Examples(
      "  dynoproof reduce line.toml\n"
      "  dynoproof reduce line.toml --sound /usr/bin/dynoproof\n"
      "  dynoproof reduce line.toml --data bench.csv --map bench.map.toml --check \"nrmse T_shaft\"\n"
      "  dynoproof reduce backlash/clamped --check \"solvers T_shaft\" --out small.toml");
  command.Runs([arguments] {
    const bool record = !arguments->data.empty();
    if (arguments->out.empty()) arguments->out = record ? "reduced.csv" : "reduced.toml";
    return record ? ReduceRecord({arguments->scenario, arguments->data, arguments->map, arguments->check,
                                  arguments->out, arguments->overrides, arguments->most_runs},
                                 arguments->common)
                  : Reduce(*arguments);
  });
}

}  // namespace dynoproof::app
