// dynoproof bisect
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <set>

#include "app/app.h"
#include "app/commits.h"
#include "app/interruption.h"
#include "base/process.h"
#include "base/text.h"
#include "experiment/compare_traces.h"
#include "history/first_change.h"
#include "scenario/changes.h"
#include "scenario/load.h"
#include "trace/trace_io.h"

namespace dynoproof::app {
namespace {

namespace fs = std::filesystem;
using history::Look;

struct BisectArguments {
  Common common;
  std::string scenario, good, bad = "HEAD", check, build, program, work = "out/bisect";
  bool diagnose = true;
};

constexpr double kCounters = 0.1;   // as the golden comparison: rounding moves an adaptive step now and then
constexpr int kDiagnoseCpu_s = 60;  // what the sentence may cost

/// What a commit's run says.
struct Outcome {
  std::string cannot;  // why there is none
  std::string verdict, broken;
  std::map<std::string, std::string> checks;  // verdict by name
  std::map<std::string, double> counters;
  std::string trace;  // file

  std::set<std::string> Failing() const {
    std::set<std::string> failing;
    for (const auto& [name, of] : checks) {
      if (of != "pass") failing.insert(name);
    }
    return failing;
  }
};

/// Where a changed value stands among those that a commit changed: what is simulated before what is asked of it, and words last.
std::size_t RankOf(const std::string& change) {
  static const std::vector<std::string> kOrder = {"plant",  "part", "control", "effect", "input",
                                                  "output", "run",  "variant", "check"};
  const std::string path = change.substr(0, change.find(' '));
  for (const char* words : {".description", ".origin", ".unit"}) {
    if (path.ends_with(words)) return kOrder.size() + 1;
  }
  const auto of = std::ranges::find(kOrder, path.substr(0, path.find('.')));
  return static_cast<std::size_t>(of - kOrder.begin());
}

/// The changes of a scenario that may have changed its run, as few words: the first of them, and how many there are besides.
std::string InASentence(const std::vector<std::string>& changes) {
  const std::size_t rank = RankOf(changes.front());
  const auto alike = std::ranges::count_if(changes, [rank](const std::string& one) { return RankOf(one) == rank; });
  return changes.front() + (alike > 1 ? fmt::format(" and {} more", alike - 1) : "");
}

std::string Short(const Commit& commit) { return commit.hash.substr(0, 12); }

class Bisection {
 public:
  Bisection(const BisectArguments& arguments, Commits commits)
      : arguments_(arguments), commits_(std::move(commits)), work_(fs::absolute(arguments.work)) {
    std::error_code error;
    const fs::path root = commits_.root();
    // A scenario that is a file here is the same file of each commit.
    if (fs::exists(arguments.scenario, error))
      scenario_ = fs::proximate(fs::absolute(arguments.scenario), root).string();
    else
      scenario_ = arguments.scenario;
    build_ = arguments.build;
    program_ = arguments.program;
    const bool ours = fs::exists(root / "ci/build.sh", error) && fs::exists(root / "engine/app", error);
    if (program_.empty() && build_.empty() && ours) {
      build_ = "./ci/build.sh build dynoproof";
      program_ = "build/dynoproof";
    }
    if (program_.empty()) program_ = fs::read_symlink("/proc/self/exe", error).string();
    if (program_.find('/') != std::string::npos && fs::path(program_).is_relative() && build_.empty())
      program_ = fs::absolute(program_).string();
    // Runs of another scenario or program do not go on from here.
    work_ /= Fingerprint(
        fmt::format("{}\n{}\n{}\n{}", scenario_, build_, program_, fmt::join(arguments.common.plugins, "\n")));
  }

  int Run() {
    std::error_code error;
    fs::create_directories(work_, error);
    good_ = At(commits_.good());
    if (!good_.cannot.empty()) return Fault(fmt::format("{}: {}", Short(commits_.good()), good_.cannot), kUsage);
    if (!arguments_.check.empty() && !good_.checks.contains(arguments_.check)) {
      std::vector<std::string> names;
      for (const auto& [name, verdict] : good_.checks) names.push_back(name);
      return Fault(fmt::format("there is no check \"{}\" at {}; it has {}", arguments_.check, Short(commits_.good()),
                               fmt::join(names, ", ")),
                   kUsage);
    }
    good_trace_ = TraceOf(good_);
    const auto& series = commits_.series();
    const history::FirstChange change = history::FindFirstChange(series.size(), [&](std::size_t i) {
      const Outcome outcome = At(series[i]);
      const Look look = !outcome.cannot.empty() ? Look::kCannot : Changed(outcome) ? Look::kChanged : Look::kSame;
      Say(series[i], look, outcome);
      return look;
    });
    ClearProgress();
    if (!change.found) {
      const Outcome& last = outcomes_.contains(series.back().hash) ? outcomes_.at(series.back().hash) : good_;
      if (!last.cannot.empty()) return Fault(fmt::format("{}: {}", Short(series.back()), last.cannot), kBroken);
      return Fault(fmt::format("{} is as {}: there is nothing to find", Short(series.back()), Short(commits_.good())),
                   kShort);
    }
    const int exit = Report(change);
    commits_.Remove(tree());
    return exit;
  }

 private:
  std::string tree() const { return (work_ / "tree").string(); }

  int Fault(const std::string& text, int exit) {
    ClearProgress();
    Complain(text + "\n");
    commits_.Remove(tree());
    return exit;
  }

  void Say(const Commit& commit, Look look, const Outcome& outcome) {
    ClearProgress();
    Note(fmt::format("{}  {:<8} {}{}\n", Short(commit),
                     look == Look::kSame      ? "same"
                     : look == Look::kChanged ? "changed"
                                              : "cannot",
                     commit.subject, look == Look::kCannot ? " (" + outcome.cannot.substr(0, 200) + ")" : ""));
  }

  /// The outcome at a commit, from an earlier call where that was cut off.
  const Outcome& At(const Commit& commit) {
    const auto known = outcomes_.find(commit.hash);
    if (known != outcomes_.end()) return known->second;
    const fs::path json = work_ / (commit.hash + ".json");
    std::error_code error;
    Outcome outcome;
    if (!fs::exists(json, error)) outcome.cannot = Make(commit, json);
    if (outcome.cannot.empty()) Read(json, outcome);
    return outcomes_[commit.hash] = std::move(outcome);
  }

  /// Builds and runs. Why that did not come to a result; empty where it did.
  std::string Make(const Commit& commit, const fs::path& json) {
    ShowProgress(fmt::format("{} {}", Short(commit), commit.subject), 0.0);
    if (const Status failed = commits_.CheckOut(commit.hash, tree())) return failed->ToString();
    if (!build_.empty()) {
      ++builds_;
      const ProgramEnd built = RunProgram({"sh", "-c", fmt::format("cd {} && {}", ShellQuoted(tree()), build_)});
      if (built.exit != 0) return "cannot be built: " + LastLine(built.out);
    }
    // The commit's own scenarios and golden data, whatever stands in this process' environment.
    std::vector<std::string> words = {"env", "-u", "DYNOPROOF_SCENARIOS", "-u", "DYNOPROOF_GOLDEN"};
    std::error_code error;
    if (build_.empty()) {
      for (const auto& [variable, folder] :
           {std::pair("DYNOPROOF_SCENARIOS", "scenarios"), std::pair("DYNOPROOF_GOLDEN", "golden")}) {
        if (fs::is_directory(fs::path(tree()) / folder, error))
          words.push_back(fmt::format("{}={}/{}", variable, tree(), folder));
      }
    }
    const std::string out = (work_ / commit.hash).string();
    std::string command =
        fmt::format("cd {} && exec {} run {} --out {} --json {}", ShellQuoted(tree()), ShellQuoted(program_),
                    ShellQuoted(scenario_), ShellQuoted(out), ShellQuoted(json.string() + ".part"));
    for (const std::string& plugin : arguments_.common.plugins) command += " --plugin " + ShellQuoted(plugin);
    words.insert(words.end(), {"sh", "-c", command});
    const ProgramEnd end = RunProgram(words);
    if (end.exit != kGood && end.exit != kShort && end.exit != kBroken && end.exit != kUndecided)
      return fmt::format("`run` ends with {}: {}", end.exit, LastLine(end.out));
    fs::rename(json.string() + ".part", json, error);
    return error ? "`run` wrote no result" : "";
  }

  static std::string LastLine(std::string text) {
    while (text.ends_with('\n')) text.pop_back();
    return text.substr(text.rfind('\n') + 1);
  }

  void Read(const fs::path& json, Outcome& outcome) const {
    const auto document = nlohmann::json::parse(ReadTextFile(json.string()).value_or(""), nullptr, false);
    if (!document.contains("scenarios") || document["scenarios"].size() != 1) {
      outcome.cannot = json.string() + " holds no single scenario";
      return;
    }
    const nlohmann::json& one = document["scenarios"][0];
    outcome.verdict = one.value("verdict", "");
    outcome.broken = one.value("broken", "");
    outcome.trace = one.value("trace", "");
    for (const auto& check : one.value("checks", nlohmann::json::array()))
      outcome.checks[check.value("name", "")] = check.value("verdict", "");
    const nlohmann::json counters = one.value("counters", nlohmann::json::object());
    for (const auto& [name, count] : counters.items()) outcome.counters[name] = count.get<double>();
  }

  std::optional<trace::Trace> TraceOf(const Outcome& outcome) const {
    if (outcome.trace.empty()) return std::nullopt;
    // As the run wrote it: from the folder of its commit.
    Result<trace::Trace> read = trace::ReadTrace(
        fs::path(outcome.trace).is_absolute() ? outcome.trace : (fs::path(tree()) / outcome.trace).string());
    return read.ok() ? std::optional(*std::move(read)) : std::nullopt;
  }

  std::vector<score::Check> Compared(const std::optional<trace::Trace>& left, const Outcome& b) const {
    const auto right = TraceOf(b);
    if (!left || !right) return {};
    std::vector<score::Check> checks = CompareTraces(*left, *right, {}, "trace");
    std::erase_if(checks, [](const score::Check& check) { return check.verdict == score::Verdict::kPass; });
    return checks;
  }

  static std::vector<std::string> CountersApart(const Outcome& a, const Outcome& b) {
    std::vector<std::string> apart;
    for (const auto& [name, was] : a.counters) {
      const auto is = b.counters.find(name);
      if (is != b.counters.end() && std::abs(is->second - was) > kCounters * std::max(was, 1.0))
        apart.push_back(fmt::format("{} from {:.0f} to {:.0f}", name, was, is->second));
    }
    return apart;
  }

  /// Whether the run is not like that of the good commit.
  bool Changed(const Outcome& b) const {
    const Outcome& a = good_;
    if (!arguments_.check.empty()) {
      const auto of = b.checks.find(arguments_.check);
      return of == b.checks.end() || of->second != a.checks.at(arguments_.check);
    }
    return a.verdict != b.verdict || a.Failing() != b.Failing() || !CountersApart(a, b).empty() ||
           !Compared(good_trace_, b).empty();
  }

  /// "as if stiffness_change at shaft:k3: delta = -0.011": one run diagnosed as a record of the other's model.
  nlohmann::json Diagnosed(const trace::Trace& before, const std::string& after) const {
    const std::string scenario = (work_ / "before.toml").string();
    if (WriteText(scenario, before.scenario) != kGood) return nullptr;
    std::error_code error;
    const std::string own = fs::read_symlink("/proc/self/exe", error).string();
    const ProgramEnd end =
        RunProgram({own, "diagnose", scenario, "--data", after, "--most-cpu", std::to_string(kDiagnoseCpu_s), "--out",
                    (work_ / "diagnosis").string(), "--json", "-"},
                   ErrorLines::kDropped);
    const auto document = nlohmann::json::parse(end.out, nullptr, false);
    if (!document.is_object() || document.value("effects", nlohmann::json::array()).empty()) return nullptr;
    const std::string verdict = document.value("verdict", "");
    return verdict == "effect_found" || verdict == "main_cause" ? document["effects"][0] : nlohmann::json();
  }

  static std::string AsIf(const nlohmann::json& effect) {
    std::string text = fmt::format("as if {} at {}", effect.value("name", ""), effect.value("at", ""));
    const char* between = ": ";
    const nlohmann::json parameters = effect.value("parameters", nlohmann::json::object());
    for (const auto& [name, of] : parameters.items()) {
      const std::string unit = of.value("unit", "1");
      text += fmt::format("{}{} = {:.4g}{}", between, name, of.value("value", 0.0), unit == "1" ? "" : " " + unit);
      between = ", ";
    }
    return text;
  }

  int Report(const history::FirstChange& change) {
    const auto& series = commits_.series();
    const Commit& first = series[change.first];
    const Commit& parent = change.since == 0 ? commits_.good() : series[change.since - 1];
    const Outcome before = At(parent), after = At(first);
    const auto was = TraceOf(before), is = TraceOf(after);
    std::vector<std::string> scenario;
    if (was && is) {
      const auto left = FromToml(was->scenario), right = FromToml(is->scenario);
      if (left && right) scenario = ChangesBetween(*left, *right);
      std::ranges::stable_sort(scenario, {}, RankOf);
    }
    std::vector<std::string> causes;
    for (const score::Check& check : Compared(was, after)) {
      const std::string said = check.cause.empty() ? check.shown : check.cause;
      causes.push_back(
          fmt::format("{}: {}", check.name.substr(check.name.find(' ') + 1), said.empty() ? check.explanation : said));
    }
    const std::vector<std::string> counters = CountersApart(before, after);
    nlohmann::json as_if;
    if (scenario.empty() && was && is && !causes.empty() && arguments_.diagnose) {
      ShowProgress("what it did to the physics", 1.0);
      as_if = Diagnosed(*was,
                        fs::path(after.trace).is_absolute() ? after.trace : (fs::path(tree()) / after.trace).string());
      ClearProgress();
    }
    std::vector<std::string> checks;
    for (const auto& [name, verdict] : after.checks) {
      const auto old = before.checks.find(name);
      if (old == before.checks.end() || old->second != verdict)
        checks.push_back(
            fmt::format("{}: {} (was {})", name, verdict, old == before.checks.end() ? "not there" : old->second));
    }
    // Where the run is the same it is judged otherwise, as by other golden data.
    const bool judged = scenario.empty() && causes.empty() && !checks.empty();
    const std::vector<std::string> files =
        judged ? commits_.ChangesInFiles(parent, first, scenario_) : std::vector<std::string>();
    std::string sentence = !scenario.empty()       ? "the scenario: " + InASentence(scenario)
                           : !after.broken.empty() ? "the run breaks: " + after.broken
                           : !causes.empty()       ? causes.front()
                           : !files.empty()        ? checks.front() + ", by " + files.front()
                           : !checks.empty()       ? checks.front()
                           : !counters.empty()     ? "the solver's work: " + counters.front()
                                                   : "the score";
    if (!as_if.is_null()) sentence += ", " + AsIf(as_if);

    std::string text = fmt::format(
        "{} {}\n  {}, {}\n  {}\n", Short(first), first.subject, first.when,
        change.since == change.first
            ? "the first that is not like the one before it"
            : fmt::format("or one of the {} before it that cannot be looked at", change.first - change.since),
        sentence);
    const auto list = [&text](const char* what, const std::vector<std::string>& lines) {
      if (lines.empty()) return;
      text += fmt::format("\n{}\n", what);
      for (const std::string& line : lines) text += "  " + line + "\n";
    };
    list("changed in the scenario", scenario);
    list("runs differ", causes);
    list("the solver's work", counters);
    list("checks", checks);
    list("changed in files", files);
    text += fmt::format("\n{} of {} commits looked at, {}; their runs: {}\n", change.looks, series.size(),
                        Counted(static_cast<std::size_t>(builds_), "build"), work_.string());
    Print(arguments_.common, text);
    KeepJson({{"id", scenario_},
              {"good", commits_.good().hash},
              {"bad", series.back().hash},
              {"first", {{"commit", first.hash}, {"subject", first.subject}, {"when", first.when}}},
              {"parent", parent.hash},
              {"undecided", change.first - change.since},
              {"sentence", sentence},
              {"scenario", scenario},
              {"runs", causes},
              {"counters", counters},
              {"checks", checks},
              {"files", files},
              {"as_if", as_if},
              {"looks", change.looks},
              {"builds", builds_}});
    return kGood;
  }

  const BisectArguments& arguments_;
  Commits commits_;
  fs::path work_;
  std::string scenario_, build_, program_;
  Outcome good_;
  std::optional<trace::Trace> good_trace_;  // read once: each look compares with it
  std::map<std::string, Outcome> outcomes_;
  int builds_ = 0;
};

int Bisect(const BisectArguments& arguments) {
  if (!Writable(arguments.work) || !CanWrite({arguments.common.json})) return kBroken;
  Result<Commits> commits = Commits::Between(arguments.good, arguments.bad);
  if (!commits.ok()) {
    Complain(commits.failure().ToString() + "\n");
    return commits.failure().exit_code;
  }
  const Interruption interruption(arguments.common, [&arguments] {
    return fmt::format("the runs so far are in {}: the same command goes on from there", arguments.work);
  });
  return Bisection(arguments, *std::move(commits)).Run();
}

}  // namespace

void AddBisect(Command program) {
  auto arguments = std::make_shared<BisectArguments>();
  Command command =
      program.Subcommand("bisect", "the first commit that changes a scenario's run, and what it did to the physics");
  command.Describe(
      "The first commit after GOOD whose run of a scenario is not like that of GOOD: another verdict, other failing "
      "checks, another\n"
      "trace or a tenth more or less work of the solver. Each commit is built and run in a work tree of its own.");
  command.Value("scenario", arguments->scenario, "id or file").Required();
  command.Value("--good", arguments->good, "the commit that is as it should be").Required();
  command.Value("--bad", arguments->bad, "a later one that is not (default HEAD)");
  command.Value("--check", arguments->check, "the verdict of this check alone");
  command.Value("--build", arguments->build, "how a commit's program is built (default, in this project: ci/build.sh)");
  command.Value("--program", arguments->program,
                "the program, as seen from the tree of a commit (default: what is built; without a build this one)");
  command.Value("--work", arguments->work, "runs are kept here, and an interrupted call goes on (default out/bisect)");
  command.Flag("!--no-diagnosis", arguments->diagnose, "do not ask for the physical change that would do the same");
  AddCommon(command, arguments->common);
  command.Examples(
      "  dynoproof bisect heavy_duty/soft_rotor_setup_1 --good v0.1.0\n"
      "  dynoproof bisect line.toml --good HEAD~40 --check \"golden T_shaft\"");
  command.Runs([arguments] { return Bisect(*arguments); });
}

}  // namespace dynoproof::app
