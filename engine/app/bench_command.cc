// dynoproof bench
#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "app/app.h"
#include "experiment/budget.h"
#include "experiment/prepare.h"
#include "reports/bench_page.h"
#include "reports/run_report.h"
#include "scenario/find.h"
#include "scenario/load.h"

namespace dynoproof::app {
namespace {

struct BenchArguments {
  Common common;
  std::vector<std::string> names, overrides;
  std::string html;
  BenchOptions options;
};

const char* Word(score::Verdict verdict) {
  switch (verdict) {
    case score::Verdict::kPass:
      return "pass";
    case score::Verdict::kInconclusive:
      return "inconclusive";
    case score::Verdict::kBroken:
      return "broken";
    default:
      return "fail";
  }
}

int Bench(const BenchArguments& arguments) {
  Diagnostics diagnostics;
  const auto registry = MakeRegistry(arguments.common, diagnostics);
  struct Subject {
    std::unique_ptr<Prepared> prepared;
    std::optional<Budget> budget;
  };
  std::vector<Subject> subjects;
  const bool all = arguments.names.empty();
  for (const std::string& name : all ? std::vector<std::string>{""} : arguments.names) {
    for (const std::string& file : FindScenarios(name, diagnostics)) {
      auto prepared = Prepare(file, {arguments.overrides, "", nullptr}, *registry, diagnostics);
      if (prepared == nullptr) continue;
      std::optional<Budget> budget = ReadBudget(prepared->plan, diagnostics);
      if (all && !budget) continue;  // without names: every scenario that states a budget
      subjects.push_back({std::move(prepared), budget});
    }
  }
  if (Report(diagnostics) != kGood) return kUsage;
  if (!CanWrite({arguments.html, arguments.common.json})) return kBroken;
  std::vector<reports::Timed> timed;
  nlohmann::json document = {{"scenarios", nlohmann::json::array()}};
  int exit = subjects.empty() ? kUndecided : kGood;
  for (const Subject& subject : subjects) {
    const Result<Timing> timing = Measure(*subject.prepared->rig, arguments.options);
    if (!timing.ok()) {
      Complain(timing.failure().ToString() + "\n");
      exit = reports::WorseExit(exit, kBroken);
      continue;
    }
    const std::vector<score::Check> checks =
        subject.budget ? JudgeBudget(*subject.budget, *timing) : std::vector<score::Check>();
    Print(arguments.common,
          fmt::format(
              "{}\n  {} periods{}: median {:.2f} us, 99 % {:.2f}, 99.9 % {:.2f}, longest {:.2f}; {:.0f} simulated "
              "seconds per second; heap {:+.0f} B\n",
              subject.prepared->plan.id, timing->sorted_us.size(), timing->paced ? ", paced" : "",
              timing->Quantile(0.5), timing->Quantile(0.99), timing->Quantile(0.999), timing->Quantile(1.0),
              timing->simulated_s_per_s, timing->heap_growth_bytes));
    if (timing->paced) {
      Print(arguments.common, fmt::format("  {} overruns, periods begin {:.0f} us late (99.9 %)\n", timing->overruns,
                                          timing->wake_p999_us));
    }
    Print(arguments.common, fmt::format("  machine {}\n", timing->fitness.Text()));
    nlohmann::json one = {{"id", subject.prepared->plan.id},
                          {"periods", timing->sorted_us.size()},
                          {"paced", timing->paced},
                          {"overruns", timing->overruns},
                          {"simulated_s_per_s", timing->simulated_s_per_s},
                          {"heap_growth_bytes", timing->heap_growth_bytes},
                          {"fit", timing->fitness.fit()},
                          {"fitness", timing->fitness.Text()},
                          {"quantiles_us", nlohmann::json::object()},
                          {"checks", nlohmann::json::array()}};
    for (const double q : {0.5, 0.9, 0.99, 0.999, 1.0}) one["quantiles_us"][fmt::format("{}", q)] = timing->Quantile(q);
    for (const score::Check& check : checks) {
      Print(arguments.common,
            fmt::format("  {:<32}{:>12.3g} {:<4} {} {:<10.3g} {}\n", check.name, check.value, check.unit,
                        check.at_least ? "at least" : "limit   ", check.limit, Word(check.verdict)));
      one["checks"].push_back({{"name", check.name},
                               {"kind", check.kind},
                               {"verdict", Word(check.verdict)},
                               {"value", check.value},
                               {"limit", check.limit},
                               {"limit_is", check.at_least ? "at_least" : "at_most"},
                               {"unit", check.unit},
                               {"origin", check.origin},
                               {"explanation", check.explanation}});
      exit = reports::WorseExit(exit, check.verdict == score::Verdict::kPass           ? kGood
                                      : check.verdict == score::Verdict::kInconclusive ? kUndecided
                                                                                       : kBudget);
    }
    if (checks.empty()) {
      Complain(fmt::format("{}: states no [budget]: nothing was compared\n", subject.prepared->plan.id));
      exit = reports::WorseExit(exit, kUndecided);
    }
    for (const std::string& note : timing->notes) Note(note + "\n");
    document["scenarios"].push_back(std::move(one));
    if (!arguments.html.empty()) {
      timed.push_back({subject.prepared->plan.id, 1e-3 * static_cast<double>(subject.prepared->rig->period), *timing,
                       subject.budget.value_or(Budget{}), checks});
    }
  }
  if (subjects.empty()) Complain("no scenario states a [budget]: nothing was compared\n");
  if (!arguments.html.empty()) exit = reports::WorseExit(exit, WriteHtml(arguments.html, reports::BenchPage(timed)));
  KeepJson(std::move(document));
  return exit;
}

}  // namespace

void AddBench(Command program) {
  auto arguments = std::make_shared<BenchArguments>();
  Command command = program.Subcommand("bench", "time every period of a scenario against its [budget]");
  command.Value("scenarios", arguments->names, "ids, files or folders; none: all that state a budget");
  command.Value("--set", arguments->overrides, "KEY=VALUE: override any key by its dotted path").OneWord();
  command.Flag("--paced", arguments->options.paced, "one period every period of real time; overruns are counted");
  command.Flag("--realtime-priority", arguments->options.realtime_priority, "ask for SCHED_FIFO");
  command.Value("--html", arguments->html, "write a page: verdict, limits, and how many periods took longer")
      .NamesFile();
  AddCommon(command, arguments->common);
  command.Examples(
      "  dynoproof bench suppression/adaptive --html out/bench.html\n"
      "  dynoproof bench suppression/adaptive --paced --realtime-priority --json -");
  command.Runs([arguments] { return Bench(*arguments); });
}

}  // namespace dynoproof::app
