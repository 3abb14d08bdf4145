// dynoproof compare, bless
#include <fmt/format.h>
#include <unistd.h>

#include <filesystem>
#include <nlohmann/json.hpp>

#include "app/app.h"
#include "app/extension.h"
#include "app/scratch.h"
#include "base/process.h"
#include "base/text.h"
#include "experiment/build_info.h"
#include "experiment/comparable.h"
#include "experiment/golden.h"
#include "experiment/prepare.h"
#include "experiment/run_scenario.h"
#include "reports/compare_page.h"
#include "reports/run_report.h"
#include "scenario/find.h"
#include "scenario/load.h"
#include "trace/trace_io.h"

namespace dynoproof::app {
namespace {

/// The tolerance file beside a golden trace that was written for this very trace; empty where there is none.
std::string ToleranceFileOf(const std::string& trace_file) {
  const std::string file = std::filesystem::path(trace_file).replace_extension(".toml").string();
  std::error_code error;
  if (!std::filesystem::exists(file, error)) return "";
  const Result<GoldenTolerances> read = ReadTolerances(file);
  return read.ok() && IsGoldenPair(*read, trace_file) ? file : "";
}

int Compare(const Common& common, const std::string& a, const std::string& b, const std::string& given,
            const std::string& html) {
  if (!CanWrite({html, common.json})) return kBroken;
  Diagnostics diagnostics;
  GoldenTolerances tolerances;
  const std::string own = given.empty() ? ToleranceFileOf(a) : "", tolerance_file = given.empty() ? own : given;
  if (!tolerance_file.empty()) {
    const Result<GoldenTolerances> read = ReadTolerances(tolerance_file);
    if (read.ok()) {
      tolerances = *read;
    } else {
      diagnostics.Error({tolerance_file}, read.failure().message);
    }
  }
  std::vector<std::string> notes;
  const Result<trace::Trace> left = ReadComparable(a, notes), right = ReadComparable(b, notes);
  for (const auto* trace : {&left, &right}) {
    if (!trace->ok()) diagnostics.Error({trace->failure().signal}, trace->failure().message);
  }
  if (left.ok() && right.ok()) CheckTolerances(tolerances.signals, *left, *right, diagnostics);
  if (Report(diagnostics) != kGood) return kUsage;
  ScenarioResult result;
  result.notes = std::move(notes);
  result.id = b;
  result.trace_file = b;
  // The tolerances of a golden trace tell how long the run was that it was thinned out of.
  const bool thinned = tolerances.run.samples > static_cast<std::int64_t>(left->time.size());
  result.checks = CompareTraces(*left, *right, tolerances.For(right->provenance.Text("solver").value_or("")), "tube",
                                thinned ? ReferenceIs::kThinned : ReferenceIs::kWhole, &result.notes);
  if (!own.empty()) result.notes.push_back("tolerances of " + own);
  result.verdict = score::Combine(result.checks);
  const std::vector<ScenarioResult> results = {result};
  const bool colour = ColourOn(common.json == "-" ? STDERR_FILENO : STDOUT_FILENO);
  Print(common, reports::ToTable(results, colour));
  if (result.verdict == score::Verdict::kPass) {  // else the cards below say them
    for (const std::string& note : result.notes) Print(common, fmt::format("\nnote: {}\n", note));
  }
  std::string again = fmt::format("dynoproof compare {} {}", ShellQuoted(a), ShellQuoted(b));
  if (!given.empty()) again += " --tolerance " + ShellQuoted(given);
  Print(common, reports::ToCards(results, {{b, again}}, colour));
  const int exit = reports::ExitCode(results);
  KeepJson(reports::ToJson(results));
  if (html.empty()) return exit;
  const int written = WriteHtml(html, reports::ComparePage(a, b, *left, *right, result));
  return written == kGood ? exit : written;
}

/// The standard output of a git command in a folder, or nothing when it failed.
std::optional<std::string> Git(const std::string& folder, std::vector<std::string> words) {
  words.insert(words.begin(), {"git", "-C", folder});
  ProgramEnd end = RunProgram(std::move(words), ErrorLines::kDropped);
  return end.exit == 0 ? std::optional(std::move(end.out)) : std::nullopt;
}

/// Why a run of this program must not become golden in the repository of `tree`. Only its own repository knows the
/// commit that a program was built from; there it has to be the present one, built from a clean tree: provenance that
/// names another program than the one that ran would be false.
std::string FaultOfStamp(const std::string& tree) {
  const std::string stamp = build_info::Commit(), commit = stamp.substr(0, stamp.find('+'));
  if (!Git(tree, {"cat-file", "-e", commit + "^{commit}"})) return "";
  if (commit != stamp)
    return fmt::format("this program was built from a changed tree ({}); commit, build again, then bless", stamp);
  const std::string head = Git(tree, {"rev-parse", "HEAD"}).value_or("");
  if (head.starts_with(commit)) return "";
  return fmt::format("this program was built from {}, the tree stands at {}; build again, then bless", commit,
                     head.substr(0, commit.size()));
}

struct BlessArguments {
  Common common;
  std::string id, reason, golden;
  EvidenceRecords records;
};

/// Whether git holds what the golden run is made from.
struct Tree {
  std::string refusal;  // why it may not be made golden; empty: it may
  std::string note;     // what the user should know all the same
};

/// The tree of the program's own scenarios: nothing in it but golden/ may be changed.
Tree ProgramTree() {
  // Asked of the folder that holds golden/, which the first bless has yet to make.
  const std::string tree = (std::filesystem::absolute(GoldenFolder()) / "..").lexically_normal().string();
  const std::optional<std::string> changed =
      Git(tree, {"status", "--porcelain", "--untracked-files=no", "--", ".", ":!golden"});
  if (!changed) return {"cannot ask git whether the tree is clean", ""};
  if (!changed->empty()) return {"tracked files outside golden/ are changed; commit them first:\n" + *changed, ""};
  return {FaultOfStamp(tree), ""};
}

/// The repository that holds a user's scenario: nothing in it but golden files may be changed. Outside any repository
/// there is nothing to ask, which is said and no refusal.
Tree UserTree(const std::string& file) {
  namespace fs = std::filesystem;
  std::error_code error;
  const fs::path folder = fs::absolute(file, error).lexically_normal().parent_path();
  fs::path top = folder;
  while (!fs::exists(top / ".git", error) && top != top.root_path()) top = top.parent_path();
  if (!fs::exists(top / ".git", error)) {
    return {"", fmt::format("no git repository holds {}: nothing tracks what its golden data were made from", file)};
  }
  const std::optional<std::string> changed =
      Git(folder.string(), {"status", "--porcelain", "--untracked-files=no", "--", ":(top)",
                            ":(top,exclude,glob)**/*.golden.h5", ":(top,exclude,glob)**/*.golden.toml"});
  if (!changed) return {fmt::format("cannot ask git whether the repository in {} is clean", top.string()), ""};
  if (!changed->empty())
    return {"tracked files of the scenario's repository are changed; commit them first:\n" + *changed, ""};
  const std::optional<std::string> tracked =
      Git(folder.string(), {"ls-files", "--", fs::path(file).filename().string()});
  if (tracked && tracked->empty()) return {"", fmt::format("git does not track {} yet: commit it as well", file)};
  return {};
}

/// The reason as the golden file keeps it: with the gain that spoke for an extension.
std::string ReasonWith(std::string reason, const std::optional<diagnosis::ExtensionGain>& evidence) {
  if (!evidence) return reason;
  reason.erase(reason.find_last_not_of(" \t\n") + 1);
  const bool ended = reason.ends_with('.') || reason.ends_with('!') || reason.ends_with('?');
  return reason + (ended ? " " : ". ") + diagnosis::GainSentence(*evidence);
}

int Bless(const BlessArguments& arguments) {
  const auto& [common, id, reason, golden, records] = arguments;
  const auto refuse = [](const std::string& why) {
    Complain("bless refused: " + why + "\n");
    return kUsage;
  };
  if (reason.find_first_not_of(" \t\n") == std::string::npos) return refuse("a reason is needed: --reason TEXT");
  if (UnderCi()) return refuse("a CI run does not decide what is right ($CI is set)");
  Diagnostics diagnostics;
  const std::unique_ptr<Registry> registry = MakeRegistry(common, diagnostics);
  const std::vector<std::string> files = FindScenarios(id, diagnostics);
  if (files.size() > 1) diagnostics.Error({id}, "is a folder", "bless one scenario at a time");
  PrepareOptions prepare;
  prepare.golden = golden;
  std::unique_ptr<Prepared> prepared;
  if (files.size() == 1) prepared = Prepare(files[0], prepare, *registry, diagnostics);
  if (prepared != nullptr) ChecksApply(prepared->checks, prepared->plan, *prepared->rig, diagnostics);
  if (Report(diagnostics) != kGood) return kUsage;
  const Tree tree = IsOwnScenario(files[0]) ? UserTree(files[0]) : ProgramTree();
  if (!tree.refusal.empty()) return refuse(tree.refusal);
  Diagnostics of_records;
  const Result<std::optional<diagnosis::ExtensionGain>> evidence =
      EvidenceFor(*prepared, records, *registry, of_records);
  Report(of_records);
  if (!evidence.ok()) {
    if (evidence.failure().exit_code == kUsage) return refuse(evidence.failure().ToString());
    Complain(evidence.failure().ToString() + "\n");
    return evidence.failure().exit_code;
  }
  if (*evidence && !(*evidence)->lacking.empty())
    return refuse((*evidence)->lacking + "\n" + diagnosis::ToTable(**evidence));
  const std::vector<std::string> checks = StatedChecks(prepared->plan);
  if (!ComparesWithGolden(checks)) {
    return refuse(
        fmt::format("no check of {} would compare with what is blessed; add to the file\n\n"
                    "[[check]]\nkind = \"golden\"\n",
                    prepared->plan.id));
  }
  const Scratch scratch("bless");
  if (!scratch.ok()) return kBroken;
  RunOptions options;
  options.out = scratch.folder().string();
  const ScenarioResult result = RunScenario(*prepared, options);
  const Result<trace::Trace> trace = trace::ReadTrace((scratch.folder() / (prepared->plan.id + ".h5")).string());
  if (!result.broken.empty() || !trace.ok()) {
    Complain((result.broken.empty() ? trace.failure().ToString() : result.broken) + "\n");
    return kBroken;
  }
  // An oracle outranks a golden trace, and a published figure both: a run that they refuse is not made golden.
  std::string failing;
  for (const score::Check& check : result.checks) {
    if (check.verdict == score::Verdict::kPass || IsOfGolden(check)) continue;
    failing += fmt::format("  {}: {}\n", check.name, check.explanation);
  }
  if (!failing.empty()) return refuse("other checks of the scenario fail:\n" + failing);
  PrepareOptions with_other;
  with_other.solver = prepared->rig->run.solver == "reference" ? "realtime" : "reference";
  const std::unique_ptr<Prepared> other = Prepare(files[0], with_other, *registry, diagnostics);
  if (Report(diagnostics) != kGood) return kUsage;
  const Result<Course> others = Play(*other);
  if (!others.ok()) {
    Complain(others.failure().ToString() + "\n");
    return kBroken;
  }
  const std::string kept_reason = ReasonWith(reason, *evidence);
  const GoldenRun golden_run{*trace, others->trace, checks, kept_reason};
  if (const Status failed = WriteGolden(prepared->golden, golden_run)) {
    Complain(failed->ToString() + "\n");
    return failed->exit_code == 2 ? kUsage : kBroken;
  }
  if (*evidence) Print(common, diagnosis::ToTable(**evidence));
  Print(common, fmt::format("{} and {} now hold this run; look at the change and commit it\n", prepared->golden.trace,
                            prepared->golden.tolerances));
  if (!tree.note.empty()) Complain(tree.note + "\n");
  nlohmann::json document = {{"id", prepared->plan.id},
                             {"reason", kept_reason},
                             {"golden", {prepared->golden.trace, prepared->golden.tolerances}}};
  if (*evidence) document["evidence"] = diagnosis::ToJson(**evidence);
  KeepJson(std::move(document));
  return kGood;
}

}  // namespace

void AddCompare(Command program) {
  struct Arguments {
    Common common;
    std::string a, b, tolerance, html;
  };
  auto arguments = std::make_shared<Arguments>();
  Command command = program.Subcommand("compare", "two traces, signal by signal");
  command.Value("A", arguments->a, "the reference: a trace (HDF5), or a record with time stamps (CSV, MAT)").Required();
  command.Value("B", arguments->b, "what is judged").Required();
  command.Value("--tolerance", arguments->tolerance,
                "TOML with [signal.NAME] relative_width, time_half_width_s, origin (default: that of a golden "
                "A beside it)");
  command.Value("--html", arguments->html, "write the page: both traces, and where they part").NamesFile();
  AddCommon(command, arguments->common);
  command.Examples(
      "  dynoproof compare golden/r2r/soft_rotor_setup_1.h5 out/r2r/soft_rotor_setup_1.h5\n"
      "  dynoproof compare before.h5 after.h5 --html out/compare.html");
  command.Runs([arguments] {
    return Compare(arguments->common, arguments->a, arguments->b, arguments->tolerance, arguments->html);
  });
}

void AddBless(Command program) {
  auto arguments = std::make_shared<BlessArguments>();
  Command command = program.Subcommand("bless", "make this run the golden one; needs a reason and a clean tree");
  command.Value("id", arguments->id, "the scenario").Required();
  command.Value("--reason", arguments->reason, "why the new trace is right");
  command.Value("--golden", arguments->golden,
                "folder of golden data (default: beside a scenario of one's own; golden/ for the program's)");
  command.Value("--holdout", arguments->records.holdout,
                "for a scenario with [extension]: record that took no part in the diagnosis");
  command
      .Value("--record", arguments->records.others,
             "another recorded experiment, which must not become worse; may be given several times")
      .OneWord();
  command
      .Value("--map", arguments->records.maps,
             "which column is which signal; one for all records, or one each: those of --record, then --holdout")
      .OneWord();
  AddCommon(command, arguments->common);
  command.Examples(
      "  dynoproof bless r2r/soft_rotor_setup_1 --reason \"first trace; oracle and reference agree\"\n"
      "  dynoproof bless my_line.toml --reason \"first trace\"    (my_line.golden.h5 and .toml, beside it)\n"
      "  dynoproof bless line_extended --reason \"friction at I3\" --holdout new.csv --record old.csv\n"
      "What diagnose extended is taken only if it foretells the hold-out better and no record worse (95 %).");
  command.Runs([arguments] { return Bless(*arguments); });
}

}  // namespace dynoproof::app
