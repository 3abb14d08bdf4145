// dynoproof history
#include <fmt/chrono.h>
#include <fmt/format.h>

#include <chrono>
#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>
#include <thread>

#include "app/app.h"
#include "base/calendar.h"
#include "base/cpu.h"
#include "base/text.h"
#include "experiment/run_scenario.h"
#include "history/watch.h"
#include "reports/run_report.h"
#include "reports/trend_page.h"

namespace dynoproof::app {
namespace {

using history::Finding;
using history::History;

struct HistoryArguments {
  Common common;
  std::string database = "history.sqlite", machine, commit, time, series, html;
  std::vector<std::string> files;
  history::WatchOptions watch;
  std::size_t last = 10;
};

/// Only like machines are compared: processor, instructions, number of cores.
std::string MachineClass() {
  std::string model = "unknown processor", line;
  std::ifstream information("/proc/cpuinfo");
  while (std::getline(information, line)) {
    if (!line.starts_with("model name")) continue;
    model = line.substr(line.find(':') + 2);
    break;
  }
  return fmt::format("{}, {}, {} cores", model, ToString(DetectCpuClass()), std::thread::hardware_concurrency());
}

std::string Now() {
  const std::time_t now = std::chrono::system_clock::to_time_t(std::chrono::system_clock::now());
  return fmt::format("{:%Y-%m-%dT%H:%M:%SZ}", fmt::gmtime(now));
}

int Fail(const Failure& failure) {
  Complain(failure.ToString() + "\n");
  return failure.exit_code;
}

int Add(const HistoryArguments& arguments) {
  int exit = kGood;
  if (!arguments.time.empty() && !IsSecondOfDay(arguments.time)) {
    Complain(fmt::format("--time {}: write 2026-01-31T02:00:00Z\n", arguments.time));
    exit = kUsage;
  }
  std::vector<history::Reading> readings;
  for (const std::string& file : arguments.files) {
    const std::optional<std::string> text = ReadTextFile(file);
    const nlohmann::json document = history::ParseResult(text.value_or(""));
    const Result<std::vector<history::Reading>> read =
        document.is_discarded() ? Failure{.message = text ? "is no JSON" : "cannot be read", .exit_code = 2}
                                : history::Readings(document);
    if (!read.ok()) {
      Complain(fmt::format("{}: {}\n", file, read.failure().message));
      exit = kUsage;
    } else {
      readings.insert(readings.end(), read->begin(), read->end());
    }
  }
  if (exit != kGood) return exit;  // all files or none
  Result<history::Store> store = history::Store::Open(arguments.database, true);
  if (!store.ok()) return Fail(store.failure());
  history::Night night{arguments.time.empty() ? Now() : arguments.time,
                       arguments.commit.empty() ? *BuildProvenance().Text("commit") : arguments.commit,
                       arguments.machine.empty() ? MachineClass() : arguments.machine};
  // A call that names a time may add to that night; one that names none begins a night, even within a second of the last.
  if (arguments.time.empty()) {
    const Result<history::Night> added = store->AddNight(night, readings);
    if (!added.ok()) return Fail(added.failure());
    night = *added;
  } else if (Status failed = store->Add(night, readings)) {
    return Fail(*failed);
  }
  std::vector<std::string> missing;
  for (const history::Reading& reading : readings) {
    if (reading.scatters && !reading.value) missing.push_back(reading.series);
  }
  Print(arguments.common, fmt::format("{}: {} readings of {}, commit {}, on {}\n", arguments.database, readings.size(),
                                      night.time, night.commit, night.machine));
  if (!missing.empty()) {
    Complain(fmt::format("no time, because it failed, was skipped or is not above 0: {}\n", fmt::join(missing, ", ")));
  }
  KeepJson({{"readings", readings.size()},
            {"without_value", missing},
            {"time", night.time},
            {"commit", night.commit},
            {"machine", night.machine}});
  return kGood;
}

/// "▁▂▇": the newest values of a series.
std::string Sparkline(const history::Series& series, std::size_t last) {
  static const char* const kBars[] = {"▁", "▂", "▃", "▄", "▅", "▆", "▇", "█"};
  const std::size_t from = series.values.size() > last ? series.values.size() - last : 0;
  double low = INFINITY, high = -INFINITY;
  for (std::size_t i = from; i < series.values.size(); ++i) {
    if (!series.values[i]) continue;
    low = std::min(low, *series.values[i]);
    high = std::max(high, *series.values[i]);
  }
  std::string text;
  for (std::size_t i = from; i < series.values.size(); ++i) {
    if (!series.values[i]) {
      text += "?";
      continue;
    }
    const double share = high > low ? (*series.values[i] - low) / (high - low) : 0.0;
    text += kBars[static_cast<int>(7.0 * share + 0.5)];
  }
  return text;
}

nlohmann::json OrNull(double value) { return std::isfinite(value) ? nlohmann::json(value) : nlohmann::json(); }

/// "338.9 -> 349 instructions", or what a series that is missing had last.
std::string Change(const Finding& finding, const std::string& unit) {
  const std::string shown = unit == "1" ? "" : " " + unit;
  if (finding.kind != Finding::Kind::kMissing)
    return fmt::format("{:.6g} -> {:.6g}{}", finding.before, finding.after, shown);
  return std::isfinite(finding.before) ? fmt::format("no reading, last {:.6g}{}", finding.before, shown)
                                       : "no reading, nor ever one";
}

/// The command that finds the commit between two nights: of what a scenario's run gives, where the commits differ. Else empty.
std::string BisectCommand(const History& history, const Finding& finding) {
  const std::string& name = history.series[finding.series].name;
  const bool of_a_run = name.starts_with("score/") || name.starts_with("figure/") || name.starts_with("counter/");
  const std::size_t begin = name.find('/'), end = name.rfind('/');
  if (!of_a_run || end <= begin || finding.night == 0) return "";
  const std::string &good = history.nights[finding.night - 1].commit, &bad = history.nights[finding.night].commit;
  if (good == bad) return "";
  return fmt::format("dynoproof bisect {} --good {} --bad {}", ShellQuoted(name.substr(begin + 1, end - begin - 1)),
                     ShellQuoted(good), ShellQuoted(bad));
}

nlohmann::json ToJson(const History& history, const history::Watch& watch) {
  nlohmann::json document = {{"nights", history.nights.size()},
                             {"compared", watch.compared},
                             {"too_short", watch.too_short},
                             {"findings", nlohmann::json::array()}};
  for (const Finding& finding : watch.findings) {
    document["findings"].push_back({{"kind", ToString(finding.kind)},
                                    {"series", history.series[finding.series].name},
                                    {"unit", history.series[finding.series].unit},
                                    {"since", history.nights[finding.night].time},
                                    {"commit", history.nights[finding.night].commit},
                                    {"before", OrNull(finding.before)},
                                    {"after", OrNull(finding.after)},
                                    {"p", finding.p},
                                    {"bisect", BisectCommand(history, finding)},
                                    {"recent", finding.recent}});
  }
  return document;
}

int Show(const HistoryArguments& arguments) {
  const Result<history::Store> store = history::Store::Open(arguments.database, false);
  if (!store.ok()) return Fail(store.failure());
  const Result<History> history = store->Read(arguments.machine);
  if (!history.ok()) return Fail(history.failure());
  if (history->nights.empty()) {
    Complain(fmt::format("{} has no night of machine class \"{}\"\n", arguments.database, arguments.machine));
    return kUndecided;
  }
  Print(arguments.common,
        fmt::format("{} nights on {}, the last {} of commit {}\n\n", history->nights.size(),
                    history->nights.back().machine, history->nights.back().time, history->nights.back().commit));
  nlohmann::json document = {{"series", nlohmann::json::array()}};
  std::size_t shown = 0;
  for (const history::Series& series : history->series) {
    if (series.name.find(arguments.series) == std::string::npos) continue;
    ++shown;
    const std::optional<double> newest = series.values.back();
    Print(arguments.common,
          fmt::format("{:<70} {:>12} {:<14} {}\n", series.name, newest ? fmt::format("{:.6g}", *newest) : "nothing",
                      series.unit, Sparkline(series, arguments.last)));
    nlohmann::json values = nlohmann::json::array();
    for (const std::optional<double>& value : series.values) values.push_back(value ? nlohmann::json(*value) : nullptr);
    document["series"].push_back({{"name", series.name}, {"unit", series.unit}, {"values", values}});
  }
  if (shown == 0) Complain(fmt::format("no series has \"{}\" in its name\n", arguments.series));
  int exit = shown == 0 ? kUndecided : kGood;
  if (!arguments.html.empty()) {
    exit = reports::WorseExit(exit,
                              WriteHtml(arguments.html, reports::TrendPage(*history, Look(*history, arguments.watch))));
  }
  KeepJson(std::move(document));
  return exit;
}

int Check(const HistoryArguments& arguments) {
  const Result<history::Store> store = history::Store::Open(arguments.database, false);
  if (!store.ok()) return Fail(store.failure());
  const Result<History> history = store->Read(arguments.machine);
  if (!history.ok()) return Fail(history.failure());
  const history::Watch watch = Look(*history, arguments.watch);
  for (const Finding& finding : watch.findings) {
    if (!finding.recent) continue;
    const history::Series& series = history->series[finding.series];
    Print(
        arguments.common,
        fmt::format(
            "{:<8} {:<64} {} since {} (commit {}{})\n", ToString(finding.kind), series.name,
            Change(finding, series.unit), history->nights[finding.night].time, history->nights[finding.night].commit,
            series.scatters && finding.kind != Finding::Kind::kMissing ? fmt::format(", p = {:.1e}", finding.p) : ""));
    if (const std::string command = BisectCommand(*history, finding); !command.empty())
      Print(arguments.common, fmt::format("         {}\n", command));
  }
  Print(arguments.common, fmt::format("{} nights, {} series compared, {} too short yet\n", history->nights.size(),
                                      watch.compared, watch.too_short));
  if (watch.compared == 0) Complain("nothing could be compared: a history needs two nights, times need some twenty\n");
  int exit = watch.exit_code;
  if (!arguments.html.empty())
    exit = reports::WorseExit(exit, WriteHtml(arguments.html, reports::TrendPage(*history, watch)));
  KeepJson(ToJson(*history, watch));
  return exit;
}

void AddDatabase(Command command, HistoryArguments& arguments) {
  command.Value("--db", arguments.database, "the history, an SQLite file").ShowsDefault();
  command.Value(
      "--machine", arguments.machine,
      "class of machine; only like machines are compared (add: default this one; else that of the last night)");
  AddCommon(command, arguments.common);
}

void AddWatch(Command command, HistoryArguments& arguments) {
  command.Value("--recent", arguments.watch.recent, "nights after which a change is no finding any more")
      .ShowsDefault();
  command.Value("--alpha", arguments.watch.alpha, "chance of one false finding among all times")
      .Within(1e-6, 0.5)
      .ShowsDefault();
  command.Value("--html", arguments.html, "write the trend page").NamesFile();
}

}  // namespace

void AddHistory(Command program) {
  auto arguments = std::make_shared<HistoryArguments>();
  Command command = program.Subcommand("history", "the nightly record and its change points");
  command.NeedsSubcommand();
  command.Examples(
      "  dynoproof history add out/run.json out/bench.json\n"
      "  dynoproof history show --series budget --html out/trend.html\n"
      "  dynoproof history check --recent 10");
  Command add = command.Subcommand("add", "add the figures of JSON results to a night");
  add.Value("files", arguments->files, "JSON of run, bench, ci/check_budgets.py or a Google Benchmark program")
      .Required();
  add.Value("--commit", arguments->commit, "what was measured (default: this program's commit)");
  add.Value("--time", arguments->time, "when, 2026-01-31T02:00:00Z (default: now)");
  AddDatabase(add, *arguments);
  add.Examples("  dynoproof history add out/nightly/run.json out/nightly/bench.json out/nightly/budgets.json");
  add.Runs([arguments] { return Add(*arguments); });
  Command show = command.Subcommand("show", "the newest value and course of every series");
  show.Value("--series", arguments->series, "only those with this text in their name");
  show.Value("--last", arguments->last, "nights in the little curves").ShowsDefault();
  AddDatabase(show, *arguments);
  AddWatch(show, *arguments);
  show.Examples("  dynoproof history show --series suppression/adaptive --html out/trend.html");
  show.Runs([arguments] { return Show(*arguments); });
  Command check = command.Subcommand(
      "check",
      "find level changes; ends with 1 (a score is worse, a reading is missing), 5 (a cost is), 4 (nothing compared)");
  AddDatabase(check, *arguments);
  AddWatch(check, *arguments);
  check.Examples("  dynoproof history check --html out/trend.html --json -");
  check.Runs([arguments] { return Check(*arguments); });
}

}  // namespace dynoproof::app
