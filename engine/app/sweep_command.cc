// dynoproof sweep
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <csignal>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <thread>

#include "app/app.h"
#include "base/atomic_file.h"
#include "base/json_text.h"
#include "base/text.h"
#include "base/within.h"
#include "campaign/slurm.h"
#include "campaign/summary.h"
#include "campaign/table.h"
#include "campaign/workers.h"
#include "reports/campaign_page.h"
#include "reports/run_report.h"

namespace dynoproof::app {
namespace {

namespace fs = std::filesystem;

struct SweepArguments {
  Common common;
  std::string campaign, executor = "local", out = "out", html, task, expect;
  int jobs = 0;
  std::int64_t run = -1, number = -1;
  bool resume = false;
};

volatile std::sig_atomic_t interrupted = 0;

void Interrupt(int) { interrupted = 1; }

/// "12.3 s", "4 min", "3.1 h"
std::string Duration(double seconds) {
  if (seconds < 120.0) return fmt::format("{:.0f} s", seconds);
  return seconds < 7200.0 ? fmt::format("{:.0f} min", seconds / 60.0) : fmt::format("{:.1f} h", seconds / 3600.0);
}

/// Rate and time left, by what this session has done.
class ProgressLine {
 public:
  ProgressLine(std::int64_t runs, std::int64_t before) : runs_(runs), before_(before) {}
  void Show(std::int64_t done, std::int64_t failing, std::int64_t broken, const std::string& more = "") {
    const double passed_s = Seconds();
    const double rate = passed_s > 0.0 ? static_cast<double>(done) / passed_s : 0.0;
    const std::int64_t all = before_ + done;
    std::string text = fmt::format("{} of {} runs", all, runs_);
    if (done > 0 && rate > 0.0)
      text += fmt::format(", {:.3g} a second, {} left", rate, Duration(static_cast<double>(runs_ - all) / rate));
    if (failing > 0) text += fmt::format(", {} failing", failing);
    if (broken > 0) text += fmt::format(", {} broken", broken);
    ShowProgress(text + more, static_cast<double>(all) / static_cast<double>(runs_));
  }
  double Seconds() const { return std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count(); }

 private:
  std::int64_t runs_, before_;
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

std::string Again(const SweepArguments& arguments) {
  std::string text = "dynoproof sweep " + ShellQuoted(arguments.campaign);
  if (arguments.out != "out") text += " --out " + ShellQuoted(arguments.out);
  for (const std::string& plugin : arguments.common.plugins) text += " --plugin " + ShellQuoted(plugin);
  return text;
}

nlohmann::json ToJson(const score::Rate& rate) {
  return {{"hits", rate.hits}, {"of", rate.of}, {"rate", rate.value()}, {"ci95", {rate.lower(), rate.upper()}}};
}

nlohmann::json ToJson(const campaign::Campaign& campaign, const campaign::Summary& summary) {
  using reports::Number;
  nlohmann::json document = {{"id", campaign.id},
                             {"title", campaign.title},
                             {"runs", summary.runs},
                             {"verdicts", summary.verdicts},
                             {"failing", ToJson(summary.failing)},
                             {"broken", ToJson(summary.broken)},
                             {"figures", nlohmann::json::object()},
                             {"rates", nlohmann::json::object()}};
  for (const campaign::FigureSummary& one : summary.figures) {
    nlohmann::json& figure = document["figures"][one.name];
    figure = {{"unit", one.unit}, {"runs", one.runs}};
    if (one.runs == 0) continue;
    figure.update({{"mean", one.mean},
                   {"mean_ci95", {Number(one.mean_lower), Number(one.mean_upper)}},
                   {"median_ci95", {Number(one.median_lower), Number(one.median_upper)}},
                   {"quantiles",
                    {{"0", one.least},
                     {"0.05", one.q05},
                     {"0.25", one.q25},
                     {"0.5", one.median},
                     {"0.75", one.q75},
                     {"0.95", one.q95},
                     {"1", one.largest}}},
                   {"least_run", one.least_run},
                   {"largest_run", one.largest_run}});
    for (std::size_t i = 0; i < one.rank_correlation.size(); ++i)
      figure["rank_correlation"][campaign.axes.spec(i).key] = Number(one.rank_correlation[i]);
  }
  for (const campaign::RateSummary& one : summary.rates) {
    nlohmann::json& rate = document["rates"][one.name];
    (one.group.empty() ? rate["all"] : rate["groups"][one.group]) = ToJson(one.rate);
  }
  return document;
}

std::string Percent(const score::Rate& rate) {
  return fmt::format("{:.1f} % [{:.1f}, {:.1f}]", 100.0 * rate.value(), 100.0 * rate.lower(), 100.0 * rate.upper());
}

std::string ToTable(const campaign::Campaign& campaign, const campaign::Summary& summary,
                    const std::vector<campaign::Row>& rows, const std::string& again) {
  std::string text = fmt::format("{}: {} runs", campaign.id, summary.runs);
  for (const auto& [verdict, count] : summary.verdicts) {
    if (count > 0) text += fmt::format(", {} {}", count, verdict);
  }
  text += fmt::format("; failing {}\n\n", Percent(summary.failing));
  if (!summary.figures.empty())
    text += fmt::format("{:<24}{:>6}{:>8}{:>12}{:>12}{:>12}{:>12}{:>12}  {}\n", "figure", "unit", "runs", "least",
                        "5 %", "median", "95 %", "largest", "median within (95 %)");
  for (const campaign::FigureSummary& one : summary.figures) {
    text += fmt::format("{:<24}{:>6}{:>8}", one.name, one.unit, one.runs);
    if (one.runs > 0)
      text += fmt::format("{:>12.5g}{:>12.5g}{:>12.5g}{:>12.5g}{:>12.5g}  [{:.5g}, {:.5g}]", one.least, one.q05,
                          one.median, one.q95, one.largest, one.median_lower, one.median_upper);
    text += "\n";
  }
  if (!summary.rates.empty()) text += fmt::format("\n{:<24}{:<20}{:>16}  {}\n", "rate", "", "", "with 95 % interval");
  for (const campaign::RateSummary& one : summary.rates) {
    text += fmt::format("{:<24}{:<20}{:>16}  {}\n", one.name, one.group.empty() ? "all" : one.group,
                        fmt::format("{} of {}", one.rate.hits, one.rate.of), Percent(one.rate));
  }
  for (const std::int64_t run : campaign::WorstRuns(rows, 5)) {
    const campaign::Row& row = rows[static_cast<std::size_t>(run)];
    text +=
        fmt::format("\nrun {} {}: {}\n  again: {} --run {}\n", run, score::ToString(row.verdict), row.why, again, run);
  }
  if (campaign::WorstRuns(rows, 1).empty()) {
    if (const campaign::Row* row = campaign::ClosestToItsLimit(rows))
      text += fmt::format("\nall passed; closest to its limit: run {}, {}\n  again: {} --run {}\n", row->run,
                          row->nearest, again, row->run);
  }
  return text;
}

int ExitOf(const campaign::Campaign& campaign, const campaign::Summary& summary) {
  const auto count = [&](const char* verdict) {
    const auto found = summary.verdicts.find(verdict);
    return found == summary.verdicts.end() ? std::int64_t{0} : found->second;
  };
  if (count("broken") > 0) return kBroken;
  if (!Within(summary.failing.value(), campaign.most_failing)) return kShort;
  return count("inconclusive") > 0 ? kUndecided : kGood;
}

/// From the rows to tables, summary and report.
int Finish(const SweepArguments& arguments, const campaign::Campaign& campaign, const campaign::RowStore& store) {
  const Result<campaign::Rows> rows = store.Merge();
  if (!rows.ok()) {
    Complain(rows.failure().ToString() + "\n");
    return rows.failure().exit_code;
  }
  const std::vector<campaign::Cost> costs = store.Costs();
  if (Status failed = campaign::WriteTables(campaign, *rows, costs, store.folder())) {
    Complain(failed->ToString() + "\n");
    return failed->exit_code;
  }
  const campaign::Summary summary = campaign::Summarise(campaign, rows->rows, costs);
  const std::string again = Again(arguments);
  int exit = ExitOf(campaign, summary);
  nlohmann::json document = ToJson(campaign, summary);
  exit = reports::WorseExit(
      exit, WriteText((fs::path(store.folder()) / "summary.json").string(), JsonText(document, 2) + "\n"));
  Print(arguments.common, ToTable(campaign, summary, rows->rows, again));
  Print(arguments.common,
        fmt::format("\n{:.1f} s of computing, {:.3g} ms a run, at most {:.0f} MB a worker; table: {}\n", summary.wall_s,
                    1e3 * summary.wall_s / static_cast<double>(summary.runs), summary.peak_MB,
                    (fs::path(store.folder()) / "table.csv").string()));
  if (!arguments.html.empty())
    exit = reports::WorseExit(exit, WriteHtml(arguments.html, reports::CampaignPage(campaign, *rows, summary, again)));
  document["cost"] = {{"wall_s", summary.wall_s}, {"cpu_s", summary.cpu_s}, {"peak_MB", summary.peak_MB}};
  KeepJson(std::move(document));
  return exit;
}

/// One run again, with its trace.
int Single(const SweepArguments& arguments, const campaign::Campaign& campaign) {
  if (arguments.run >= campaign.axes.runs()) {
    Complain(fmt::format("--run {}: the campaign has the runs 0 ... {}\n", arguments.run, campaign.axes.runs() - 1));
    return kUsage;
  }
  std::optional<campaign::Row> row;
  const campaign::Range range{arguments.run, arguments.run + 1};
  if (const Status failed = campaign.subject->Run(range, true, [&](campaign::Row one) { row = std::move(one); })) {
    Complain(failed->ToString() + "\n");
    return failed->exit_code;
  }
  std::string text = fmt::format("run {} of {}: {}{}{}\n", row->run, campaign.id, score::ToString(row->verdict),
                                 row->why.empty() ? "" : ": ", row->why);
  nlohmann::json document = {{"id", campaign.id},
                             {"run", row->run},
                             {"verdict", score::ToString(row->verdict)},
                             {"why", row->why},
                             {"axes", nlohmann::json::object()},
                             {"figures", nlohmann::json::object()}};
  for (std::size_t i = 0; i < campaign.axes.size(); ++i) {
    const std::string& key = campaign.axes.spec(i).key;
    const Value value = campaign.axes.At(i, row->run);
    text += fmt::format("  {:<40}{}\n", key, campaign::TextOf(value));
    document["axes"][key] =
        value.is_number() ? nlohmann::json(value.number()) : nlohmann::json(campaign::TextOf(value));
  }
  for (std::size_t i = 0; i < row->figures.size(); ++i) {
    const campaign::FigureInfo& figure = campaign.subject->figures()[i];
    text += fmt::format("  {:<40}{} {}\n", figure.name, row->figures[i], figure.unit);
    document["figures"][figure.name] = {{"value", reports::Number(row->figures[i])}, {"unit", figure.unit}};
  }
  if (const std::string command = campaign.subject->Command(row->run); !command.empty()) {
    text += "alone, with all checks of the scenario: " + command + "\n";
    document["command"] = command;
  }
  Print(arguments.common, text);
  KeepJson(std::move(document));
  return score::ExitCode(row->verdict);
}

int Stopped(const Failure& failure, const SweepArguments& arguments) {
  Complain(failure.ToString() + "\n");
  Complain(fmt::format("what is done is kept; when the cause is gone: {} --resume\n", Again(arguments)));
  return failure.exit_code;
}

/// An array task: one piece of the campaign.
int Task(const SweepArguments& arguments, const campaign::Campaign& campaign, const campaign::RowStore& store,
         const campaign::WorkOptions& common) {
  if (campaign.fingerprint != arguments.expect) {
    Complain("the campaign, its scenario or this program is not what it was when the task was submitted\n");
    return kUsage;
  }
  const Result<std::vector<campaign::Range>> pieces = campaign::ReadTaskFile(arguments.task);
  if (!pieces.ok() || arguments.number < 0 || arguments.number >= std::ssize(*pieces)) {
    Complain(fmt::format("{} has no task {}\n", arguments.task, arguments.number));
    return kUsage;
  }
  const campaign::Range piece = (*pieces)[static_cast<std::size_t>(arguments.number)];
  const std::vector<campaign::Range> stored = store.Stored();
  if (std::ranges::find(stored, piece) != stored.end()) return kGood;  // started twice, and the other was first
  campaign::WorkOptions options = common;
  options.jobs = 1;
  options.piece = piece.size();
  campaign::Tally tally;
  const Status failed = campaign::MakeRuns(campaign, store, {piece}, options, tally);
  if (failed) Complain(failed->ToString() + "\n");
  return failed ? failed->exit_code : interrupted != 0 ? kUndecided : kGood;
}

Status OnCluster(const SweepArguments& arguments, const campaign::Campaign& campaign, const campaign::RowStore& store,
                 campaign::WorkOptions options, ProgressLine& line) {
  double run_s = 0.0;
  if (campaign.slurm.runs_per_task == 0) {  // the first run says what one costs
    campaign::Tally tally;
    const std::int64_t first = store.Missing().front().begin;
    options.piece = 1;
    if (Status failed = campaign::MakeRuns(campaign, store, {{first, first + 1}}, options, tally)) return failed;
    run_s = tally.run_s;
  }
  const std::vector<campaign::Range> missing = store.Missing();
  const std::int64_t each = campaign::RunsPerTask(campaign.slurm, campaign::CountRuns(missing), run_s);
  std::error_code error;
  campaign::ClusterOptions cluster;
  cluster.command = {fs::read_symlink("/proc/self/exe", error).string(),
                     "sweep",
                     arguments.campaign,
                     "--out",
                     arguments.out,
                     "--expect",
                     campaign.fingerprint};
  for (const std::string& plugin : arguments.common.plugins)
    cluster.command.insert(cluster.command.end(), {"--plugin", plugin});
  cluster.stopped = options.stopped;
  const std::int64_t before = store.runs() - campaign::CountRuns(missing);
  cluster.progress = [&line, before](const campaign::ClusterTally& now) {
    line.Show(now.done - before, 0, 0, fmt::format(", {} tasks running, {} waiting", now.running, now.pending));
  };
  return campaign::MakeRunsOnCluster(campaign, store, campaign::Cut(missing, each), cluster);
}

int Sweep(const SweepArguments& arguments) {
  Diagnostics diagnostics;
  const std::unique_ptr<Registry> registry = MakeRegistry(arguments.common, diagnostics);
  const std::string folder = (fs::path(arguments.out) / fs::path(arguments.campaign).stem()).string();
  const std::unique_ptr<campaign::Campaign> campaign =
      campaign::LoadCampaign(arguments.campaign, folder, *registry, diagnostics);
  if (Report(diagnostics) != kGood || campaign == nullptr) return kUsage;
  if (arguments.run >= 0) return Single(arguments, *campaign);

  std::signal(SIGINT, Interrupt);
  std::signal(SIGTERM, Interrupt);
  campaign::WorkOptions options;
  options.jobs =
      arguments.jobs > 0 ? arguments.jobs : static_cast<int>(std::max(1U, std::thread::hardware_concurrency()));
  options.stopped = [] { return interrupted != 0; };
  const campaign::RowStore store(folder, campaign->fingerprint, campaign->axes.runs());
  if (!arguments.task.empty()) return Task(arguments, *campaign, store, options);

  const std::vector<campaign::Range> missing = store.Missing();
  const std::int64_t before = store.runs() - campaign::CountRuns(missing);
  if (before > 0 && !arguments.resume) {
    Complain(
        fmt::format("{} holds {} runs of a campaign already: --resume makes the others, --out DIR begins anew "
                    "elsewhere\n",
                    folder, before));
    return kUsage;
  }
  if (const Status other = store.BelongsElsewhere()) {
    Complain(other->ToString() + "\n");
    return other->exit_code;
  }
  if (!Writable(folder) || !CanWrite({arguments.html, arguments.common.json})) return kBroken;
  if (const Status failed = WriteFileAtomically(fs::path(folder) / "campaign.toml", campaign->text))
    return Stopped(*failed, arguments);

  ProgressLine line(store.runs(), before);
  campaign::Tally tally;
  options.progress = [&line](const campaign::Tally& now) { line.Show(now.done, now.failing, now.broken); };
  const bool local = arguments.executor == "local";
  const Status failed = missing.empty() ? Status()
                        : local         ? campaign::MakeRuns(*campaign, store, missing, options, tally)
                                        : OnCluster(arguments, *campaign, store, options, line);
  ClearProgress();
  if (failed) return Stopped(*failed, arguments);
  const std::int64_t left = campaign::CountRuns(store.Missing());
  if (left > 0 && interrupted != 0) {
    Complain(fmt::format("interrupted: {} of {} runs are done; go on: {} --resume\n", store.runs() - left, store.runs(),
                         Again(arguments)));
    return kUndecided;
  }
  const int exit = Finish(arguments, *campaign, store);
  if (before < store.runs()) Note(fmt::format("{} runs in {:.1f} s\n", store.runs() - before, line.Seconds()));
  return exit;
}

}  // namespace

void AddSweep(Command program) {
  auto arguments = std::make_shared<SweepArguments>();
  Command command = program.Subcommand("sweep", "a campaign: one scenario, many variations, one table");
  command.Value("campaign", arguments->campaign, "campaign file (TOML)").Required();
  command.Value("--jobs", arguments->jobs, "runs at a time (default: one a core)").Within(1, 1024);
  command.Value("--executor", arguments->executor, "local: this machine; slurm: array tasks by sbatch")
      .OneOf({"local", "slurm"});
  command.Value("--out", arguments->out, "results go to a folder named after the campaign in here (default out)");
  command.Flag("--resume", arguments->resume, "make only what is missing there");
  command.Value("--run", arguments->run, "make this run alone and show it").NotNegative();
  command.Value("--html", arguments->html, "write the report: one page with pictures that needs no network")
      .NamesFile();
  // What an array task is called with.
  command.Value("--task", arguments->task).Hidden();
  command.Value("--number", arguments->number).Hidden();
  command.Value("--expect", arguments->expect).Hidden();
  AddCommon(command, arguments->common);
  command.Examples(
      "  dynoproof sweep bench/campaigns/r2r_spread.toml\n"
      "  dynoproof sweep my_campaign.toml --jobs 4 --out out/today --resume\n"
      "  dynoproof sweep my_campaign.toml --executor slurm --out /shared/folder\n"
      "  dynoproof sweep my_campaign.toml --run 17");
  command.Runs([arguments] { return Sweep(*arguments); });
}

}  // namespace dynoproof::app
