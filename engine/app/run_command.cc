// dynoproof run
#include <fmt/format.h>
#include <unistd.h>

#include <atomic>
#include <map>
#include <mutex>
#include <new>
#include <nlohmann/json.hpp>
#include <set>

#include "app/apart.h"
#include "app/app.h"
#include "app/interruption.h"
#include "app/measured.h"
#include "base/calendar.h"
#include "base/parallel.h"
#include "base/text.h"
#include "estimation/horizon.h"
#include "experiment/prepare.h"
#include "experiment/run_scenario.h"
#include "experiment/warnings.h"
#include "identification/bring_in.h"
#include "reports/run_page.h"
#include "reports/run_report.h"
#include "scenario/find.h"
#include "scenario/load.h"

namespace dynoproof::app {
namespace {

struct RunArguments {
  Common common;
  std::vector<std::string> names, overrides;
  std::string solver, out = "out", golden, kept, junit, markdown, html, data, map, today;
  int jobs = 1;
  RunLimits limits;
};

/// The command that runs this scenario again, as a shell takes it.
std::string Again(const RunArguments& arguments, const std::string& file) {
  std::string text = "dynoproof run " + ShellQuoted(CallName(file));
  const auto add = [&text](const char* option, const std::string& value) {
    if (!value.empty()) text += fmt::format(" {} {}", option, ShellQuoted(value));
  };
  for (const std::string& change : arguments.overrides) add("--set", change);
  add("--solver", arguments.solver);
  add("--data", arguments.data);
  add("--map", arguments.map);
  add("--golden", arguments.golden);
  add("--today", arguments.today);
  for (const std::string& plugin : arguments.common.plugins) add("--plugin", plugin);
  return text;
}

/// A line that lists the references of the checks of a scenario. Two solvers integrate the same model, and agree where the model
/// is wrong.
std::string ComparedWith(const ScenarioResult& result, const Registry& registry) {
  std::map<std::string, int> with;
  for (const score::Check& check : result.checks) {
    const CheckKind* kind = registry.FindCheck(check.stated);
    const bool solvers = kind != nullptr && kind->compares_solvers;
    ++with[solvers                    ? "a second solver"
           : check.stated == "golden" ? "a golden trace"
           : check.stated == "record" ? "a measured record"
           : check.stated == "oracle" ? "an independent method"
                                      : "stated limits"];
  }
  if (with.size() == 1 && with.contains("a second solver"))
    return "compared with: a second solver alone, so the model itself is not judged; `bless` keeps a golden trace, "
           "--data compares with a record\n";
  std::string text;
  for (const auto& [what, checks] : with) text += fmt::format("{}{} ({})", text.empty() ? "" : ", ", what, checks);
  return "compared with: " + text + "\n";
}

/// Where the traces and the page are.
std::string WhatIsLeft(const std::vector<ScenarioResult>& results, const RunArguments& arguments,
                       const Registry& registry) {
  std::vector<std::string> traces;
  for (const ScenarioResult& result : results) {
    if (!result.trace_file.empty()) traces.push_back(result.trace_file);
  }
  std::string text = "\n";
  if (results.size() == 1 && results[0].verdict == score::Verdict::kPass) text += ComparedWith(results[0], registry);
  if (traces.size() == 1) text += "trace: " + traces.front() + "\n";
  if (traces.size() > 1) text += fmt::format("traces: {} in {}/, as ID.h5\n", traces.size(), arguments.out);
  return text + "page: " + (arguments.html.empty() ? "none, --html FILE writes one" : arguments.html) + "\n";
}

/// For Ctrl-C: the table of what is done, the names of what is not. The document for --json has what is done.
std::string WhatIsDone(const std::vector<std::unique_ptr<Prepared>>& scenarios,
                       const std::vector<std::optional<ScenarioResult>>& results, const RunArguments& arguments) {
  std::vector<ScenarioResult> done;
  std::string left;
  for (std::size_t i = 0; i < results.size(); ++i) {
    if (results[i])
      done.push_back(*results[i]);
    else
      left += fmt::format("\n  not done: {}", Again(arguments, scenarios[i]->plan.file));
  }
  if (!done.empty()) Print(arguments.common, reports::ToTable(done, false));
  KeepJson(reports::ToJson(done));
  return fmt::format("interrupted: {} of {} scenarios are done{}; no report is written, and no half of a trace{}\n",
                     done.size(), scenarios.size(),
                     done.empty() ? "" : fmt::format(", their traces are in {}/", arguments.out), left);
}

/// Runs the prepared scenarios, `jobs` at a time, in the order given.
std::vector<ScenarioResult> RunAll(const std::vector<std::unique_ptr<Prepared>>& scenarios,
                                   const RunArguments& arguments, const MappedRecord* data, reports::RunPage& page) {
  std::vector<std::optional<ScenarioResult>> results(scenarios.size());
  std::atomic<std::size_t> done = 0;
  std::mutex screen;
  const Interruption interruption(arguments.common, [&] {
    const std::lock_guard<std::mutex> lock(screen);
    return WhatIsDone(scenarios, results, arguments);
  });
  const auto tell = [&](std::size_t i, double fraction) {
    const std::lock_guard<std::mutex> lock(screen);
    ShowProgress(fmt::format("{} of {} done, now {}", done.load(), scenarios.size(), scenarios[i]->plan.id),
                 (static_cast<double>(done.load()) + fraction) / static_cast<double>(scenarios.size()));
  };
  const auto make = [&](std::size_t i, bool progress) {
    RunOptions options;
    options.out = arguments.out;
    options.data = data;
    options.today = arguments.today;
    options.kept = arguments.kept;
    if (progress) options.progress = [&, i](double fraction) { return tell(i, fraction), true; };
    if (!arguments.html.empty()) {
      options.seen = [&, i](const Course& course, const ScenarioResult& result) {
        page.Add(*scenarios[i], course, result);
      };
    }
    std::string thrown;  // out of memory, or a fault of a plugin: the others go on
    try {
      return RunScenario(*scenarios[i], options);
    } catch (const std::bad_alloc&) {
      thrown = "out of memory";
    } catch (const std::exception& error) {
      thrown = error.what();
    } catch (...) {
      thrown = "an exception that is none of the standard library's";
    }
    return BrokenResult(scenarios[i]->plan.id, std::move(thrown));
  };
  // What strangers wrote may crash, hang or end the program: it does so in a process of its own.
  const bool strangers = !scenarios.empty() && !scenarios.front()->registry->libraries().empty();
  if (strangers || arguments.limits.most_seconds > 0.0 || arguments.limits.most_memory_MB > 0.0) {
    std::vector<ScenarioResult> all = RunApart(
        scenarios.size(), arguments.jobs, arguments.limits, page, [&](std::size_t i) { return scenarios[i]->plan.id; },
        [&](std::size_t i) { return make(i, false); },
        [&](std::size_t i, const ScenarioResult& result) {
          {
            const std::lock_guard<std::mutex> lock(screen);
            results[i] = result;
            ++done;
          }
          tell(i, 0.0);
        });
    ClearProgress();
    return all;
  }
  ParallelFor(scenarios.size(), static_cast<unsigned>(arguments.jobs), [&](std::size_t i) {
    ScenarioResult result = make(i, true);
    const std::lock_guard<std::mutex> lock(screen);
    results[i] = std::move(result);
    ++done;
  });
  ClearProgress();
  std::vector<ScenarioResult> all;
  for (std::optional<ScenarioResult>& result : results) all.push_back(*std::move(result));
  return all;
}

std::optional<MappedRecord> ReadData(const RunArguments& arguments, const Rig& rig, Diagnostics& diagnostics) {
  return OpenRecord(arguments.data, arguments.map, InputNames(rig), OutputNames(rig), diagnostics);
}

/// How far ahead the scenario predicts the record that drives it; nothing where that cannot be said.
std::optional<estimation::Horizon> HorizonOf(const std::vector<ScenarioResult>& results, const Prepared& prepared,
                                             const std::optional<MappedRecord>& data) {
  if (!data || data->outputs.empty() || !results.front().broken.empty()) return std::nullopt;
  Result<std::optional<estimation::Horizon>> horizon = estimation::HorizonOf(prepared.plan, *data, *prepared.registry);
  if (horizon.ok()) return *std::move(horizon);
  Note(fmt::format("how far ahead the scenario predicts is not told: {}\n", horizon.failure().ToString()));
  return std::nullopt;
}

int Run(const RunArguments& arguments) {
  Diagnostics diagnostics;
  const std::unique_ptr<Registry> registry = MakeRegistry(arguments.common, diagnostics);
  std::vector<std::string> files;
  std::set<std::string> known;
  for (const std::string& name : arguments.names.empty() ? std::vector<std::string>{""} : arguments.names) {
    for (const std::string& file : FindScenarios(name, diagnostics)) {
      if (known.insert(file).second) files.push_back(file);
    }
  }
  if (!arguments.data.empty() && files.size() > 1)
    diagnostics.Error({"--data"}, "drives one scenario, not several", "name one");
  if (arguments.data.empty() && !arguments.map.empty())
    diagnostics.Error({"--map"}, "belongs to --data", "add --data FILE");
  if (!arguments.kept.empty() && !arguments.data.empty())
    diagnostics.Error({"--kept"}, "has nothing to keep: a record's comparison takes the place of the checks",
                      "leave it out");
  if (!arguments.kept.empty() && UnderCi())
    diagnostics.Error({"--kept"}, "is for a person: a CI run computes both solvers ($CI is set)", "leave it out");
  PrepareOptions options;
  options.overrides = arguments.overrides;
  options.solver = arguments.solver;
  options.golden = arguments.golden;
  std::vector<std::unique_ptr<Prepared>> scenarios;
  std::set<std::string> ids;
  for (const std::string& file : files) {
    std::unique_ptr<Prepared> prepared = Prepare(file, options, *registry, diagnostics);
    if (prepared == nullptr) continue;
    if (!ids.insert(prepared->plan.id).second) {
      diagnostics.Error({file}, fmt::format("a second scenario has the id \"{}\"", prepared->plan.id),
                        "rename one file");
    }
    scenarios.push_back(std::move(prepared));
  }
  // A record is another experiment: the checks of the scenario's own excitation do not apply to it.
  if (arguments.data.empty()) {
    for (const std::unique_ptr<Prepared>& one : scenarios) AddWarnings(*one, diagnostics);
  }
  std::optional<MappedRecord> data;
  if (!arguments.data.empty() && scenarios.size() == 1) {
    data = ReadData(arguments, *scenarios[0]->rig, diagnostics);
    if (data && identification::BringIn(scenarios[0]->plan, *registry, *data, diagnostics)) {
      options.data = &*data;
      // A scenario that a diagnosis has extended may hold the start that it found along with the cause.
      if (scenarios[0]->plan.root.FindPath("extension.start") == nullptr)
        options.start = BeginAsRecorded(scenarios[0]->plan, *registry, *data);
      scenarios[0] = Prepare(files[0], options, *registry, diagnostics);
    }
  }
  for (const auto& one : scenarios) {
    if (one != nullptr) ChecksApply(one->checks, one->plan, *one->rig, diagnostics);
  }
  if (Report(diagnostics) != kGood) return kUsage;
  if (!Writable(arguments.out) || (!arguments.kept.empty() && !Writable(arguments.kept))) return kBroken;
  if (!CanWrite({arguments.junit, arguments.markdown, arguments.html, arguments.common.json})) return kBroken;

  reports::RunPage page(scenarios.size());
  const std::vector<ScenarioResult> results = RunAll(scenarios, arguments, data ? &*data : nullptr, page);
  int exit = reports::ExitCode(results);
  std::map<std::string, std::string> again;
  for (const std::unique_ptr<Prepared>& one : scenarios) again[one->plan.id] = Again(arguments, one->plan.file);
  const bool colour = ColourOn(arguments.common.json == "-" ? STDERR_FILENO : STDOUT_FILENO);
  Print(arguments.common, reports::ToTable(results, colour));
  Print(arguments.common, reports::ToCards(results, again, colour));
  const std::optional<estimation::Horizon> horizon =
      results.empty() ? std::nullopt : HorizonOf(results, *scenarios.front(), data);
  if (horizon) Print(arguments.common, horizon->ToText());
  Print(arguments.common, WhatIsLeft(results, arguments, *registry));
  // A person at a terminal has the notes of what did not pass in its card; a log has them wherever else it looks.
  const bool cards_seen = IsTerminal(STDOUT_FILENO) && IsTerminal(STDERR_FILENO);
  for (const ScenarioResult& result : results) {
    if (cards_seen && result.verdict != score::Verdict::kPass) continue;
    for (const std::string& note : result.notes) Note(fmt::format("{}: {}\n", result.id, note));
  }
  if (!arguments.junit.empty()) exit = reports::WorseExit(exit, WriteText(arguments.junit, reports::ToJUnit(results)));
  if (!arguments.markdown.empty())
    exit = reports::WorseExit(exit, WriteText(arguments.markdown, reports::ToMarkdown(results)));
  if (!arguments.html.empty()) exit = reports::WorseExit(exit, WriteHtml(arguments.html, page.Finish(results)));
  nlohmann::json document = reports::ToJson(results);
  if (horizon) AddTo(document["scenarios"].front(), *horizon);
  KeepJson(std::move(document));
  return exit;
}

}  // namespace

void AddRun(Command program) {
  auto arguments = std::make_shared<RunArguments>();
  Command command = program.Subcommand("run", "run scenarios and score them (physics only; timing: bench)");
  command.Value("scenarios", arguments->names, "ids, files or folders; none: all");
  command.Value("--solver", arguments->solver, "realtime or reference, instead of the scenario's own")
      .OneOf({"realtime", "reference"});
  command.Value("--set", arguments->overrides, "KEY=VALUE: override any key by its dotted path").OneWord();
  command.Value("--jobs", arguments->jobs, "scenarios at a time").Within(1, 1024);
  command.Value("--most-seconds", arguments->limits.most_seconds, "a scenario that takes longer is broken")
      .NotNegative();
  command.Value("--most-memory", arguments->limits.most_memory_MB, "MB: a scenario that asks for more is broken")
      .NotNegative();
  command.Value("--out", arguments->out, "folder of traces (default out)");
  command.Value("--golden", arguments->golden,
                "folder of golden data (default: beside a scenario of one's own; golden/ for the program's)");
  command.Value(
      "--kept", arguments->kept,
      "keep the second solver's samples in this folder, and compute them again only where they may have changed");
  command.Value("--junit", arguments->junit, "write JUnit XML").NamesFile();
  command.Value("--markdown", arguments->markdown, "write a Markdown summary").NamesFile();
  command.Value("--html", arguments->html, "write the report: one page with pictures that needs no network")
      .NamesFile();
  command.Value("--data", arguments->data,
                "drive the inputs with this record (CSV, HDF5, MAT) and compare its outputs");
  command
      .Value("--today", arguments->today,
             "2026-01-31: decide on the accepted gaps of [record] as on that day (default: the clock's)")
      .Checked([](const std::string& day) { return IsDay(day) ? "" : "write 2026-01-31, not " + day; }, "DAY");
  command.Value("--map", arguments->map, "which column of --data is which signal (TOML)");
  AddCommon(command, arguments->common);
  command.Examples(
      "  dynoproof run r2r/soft_rotor_setup_1\n"
      "  dynoproof run heavy_duty/ --jobs 2 --junit out/junit.xml\n"
      "  dynoproof run r2r/soft_rotor_setup_1 --kept out/kept\n"
      "  dynoproof run backlash/experiment_1 --html out/report.html\n"
      "  dynoproof run diagnose/heavy_duty_lumped --set run.duration_s=0.5 --solver reference\n"
      "  dynoproof run diagnose/r2r_soft --data record.csv --map map.toml");
  command.Runs([arguments] { return Run(*arguments); });
}

}  // namespace dynoproof::app
