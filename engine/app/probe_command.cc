// dynoproof probe
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <fstream>
#include <nlohmann/json.hpp>

#include "app/app.h"
#include "app/interruption.h"
#include "app/one_scenario.h"
#include "base/json_text.h"
#include "base/text.h"
#include "experiment/golden.h"
#include "experiment/prepare.h"
#include "experiment/run_scenario.h"
#include "probe/proposal.h"
#include "probe/report.h"
#include "reports/probe_page.h"
#include "scenario/load.h"

namespace dynoproof::app {
namespace {

struct ProbeArguments {
  Common common;
  std::string scenario, html, resume, write;
  std::vector<std::string> overrides, without, effects, see;
  int jobs = 0;  // 0: one a core
};

/// A fingerprint of all that findings depend on: the scenario, the program, its solver and --without. A file of --resume that
/// carries another one belongs to another probe.
std::string KeyOf(const Prepared& prepared, const ProbeArguments& arguments) {
  const trace::Provenance build = BuildProvenance();
  return Fingerprint(fmt::format("{} {} {} {}", ToToml(prepared.plan.root), build.Text("commit").value_or(""),
                                 fmt::join(arguments.without, ","), prepared.rig->run.solver));
}

/// Findings by earlier calls, a line each behind a first one that says what they belong to; the file is made where there is none.
/// A last line without its end is one that a kill cut off.
class Kept {
 public:
  explicit Kept(const std::string& file) : file_(file) {}

  /// False, and a complaint, where the file is of something else or cannot be written.
  bool Open(const std::string& key) {
    if (file_.empty()) return true;
    const std::string first = JsonText(nlohmann::json{{"probe", key}}) + "\n";
    std::string text = ReadTextFile(file_).value_or("");
    text.erase(text.rfind('\n') + 1);
    if (text.empty()) text = first;
    if (!text.starts_with(first)) {
      Complain(fmt::format(
          "{}: these findings are of another scenario, program or --without: name another file, or remove it\n",
          file_));
      return false;
    }
    std::size_t begin = first.size();
    for (std::size_t end; (end = text.find('\n', begin)) != std::string::npos; begin = end + 1) {
      const auto document = nlohmann::json::parse(text.substr(begin, end - begin), nullptr, false);
      if (auto finding = probe::FromJson(document)) findings.push_back(*std::move(finding));
    }
    if (WriteText(file_, text) != kGood) return false;
    stream_.open(file_, std::ios::app);
    return stream_.good();
  }
  void Add(const probe::Finding& finding) {
    if (!stream_.is_open() || std::ranges::count(findings, Name(finding), &Kept::Name) > 0) return;
    stream_ << JsonText(probe::ToJson(finding)) + "\n" << std::flush;
  }
  bool Good() const { return file_.empty() || stream_.good(); }

  std::vector<probe::Finding> findings;

 private:
  static std::string Name(const probe::Finding& one) { return fmt::format("{}@{} {}", one.name, one.place, one.sign); }

  std::string file_;
  std::ofstream stream_;
};

/// The names that --effects and --see may have.
std::vector<std::string> NamesOf(const Registry& registry) {
  std::vector<std::string> names = {probe::kTurnedSign, probe::kDroppedTerm};
  for (const Effect* effect : registry.Effects()) names.push_back(effect->info().name);
  return names;
}

bool AreNames(const std::vector<std::string>& words, const char* option, const Registry& registry) {
  const std::vector<std::string> names = NamesOf(registry);
  bool good = true;
  for (const std::string& word : words) {
    if (std::ranges::count(names, word) > 0) continue;
    const auto near = Closest(word, names);
    Complain(fmt::format("{}: there is no change \"{}\"{}\n", option, word,
                         near ? fmt::format("; did you mean \"{}\"?", *near) : "; dynoproof list has the effects"));
    good = false;
  }
  return good;
}

/// The demands as a table, and whether all are met.
bool Meets(const std::vector<probe::Demand>& demands, const probe::Probed& probed, std::string& text,
           nlohmann::json& document) {
  bool all = true;
  for (const probe::Demand& demand : demands) {
    const std::vector<const probe::Finding*> unmet = probe::Unmet(demand, probed.findings);
    const bool tried = std::ranges::any_of(probed.findings, [&](const auto& one) { return one.name == demand.name; });
    const bool met = unmet.empty() && tried;
    all = all && met;
    text += fmt::format("{}  {} is to be seen{}{}\n", met ? "met      " : "NOT MET  ", demand.name,
                        demand.strength > 0.0 ? fmt::format(" at {:g}", demand.strength) : " at what is usual",
                        tried ? "" : ": it has no place in this scenario");
    nlohmann::json places = nlohmann::json::array();
    for (const probe::Finding* one : unmet) {
      text += fmt::format("           {}: {}\n", one->place, probe::PassesText(*one));
      places.push_back(one->place);
    }
    document.push_back({{"effect", demand.name},
                        {"strength", demand.strength > 0.0 ? nlohmann::json(demand.strength) : nlohmann::json()},
                        {"met", met},
                        {"passes_at", places}});
  }
  return all;
}

/// What would see the holes, as text; the lines go to the file of --write.
int SayProposals(const ProbeArguments& arguments, const Prepared& prepared, const probe::Probed& probed,
                 std::string& text, nlohmann::json& document) {
  // A golden trace does not see what is blessed with it.
  const bool asked = std::ranges::count(arguments.without, GoldenCheck::kName) == 0;
  const std::vector<probe::Proposal> proposals =
      asked ? probe::Propose(probed.findings, probed.apart) : std::vector<probe::Proposal>();
  if (!proposals.empty()) text += "\nwould see it at half of what is usual\n";
  for (const probe::Proposal& one : proposals) {
    text += fmt::format(
        "  golden {} within {:g} of its nominal: {} (two solvers are {:.1g} apart)\n", one.output, one.relative_width,
        one.sees.size() <= 3 ? fmt::format("{}", fmt::join(one.sees, ", ")) : Counted(one.sees.size(), "error"),
        one.builds);
    document.push_back({{"output", one.output},
                        {"kind", GoldenCheck::kName},
                        {"relative_width", one.relative_width},
                        {"sees", one.sees}});
  }
  if (arguments.write.empty()) return kGood;
  const std::vector<std::string> stated = StatedChecks(prepared.plan);
  return WriteText(arguments.write, proposals.empty() ? "# nothing to propose\n"
                                                      : probe::ToLines(proposals, ComparesWithGolden(stated)));
}

int Probe(const ProbeArguments& arguments) {
  Diagnostics diagnostics;
  const std::unique_ptr<Registry> registry = MakeRegistry(arguments.common, diagnostics);
  const std::optional<std::string> file = OneScenario(arguments.scenario, diagnostics);
  std::unique_ptr<Prepared> prepared;
  if (file) prepared = Prepare(*file, {arguments.overrides, "", nullptr}, *registry, diagnostics);
  if (Report(diagnostics) != kGood || prepared == nullptr) return kUsage;
  std::vector<probe::Demand> demands;
  std::vector<std::string> names;
  for (const std::string& text : arguments.see) {
    const auto demand = probe::ParseDemand(text);
    if (!demand) {
      Complain(fmt::format("--see {}: write CHANGE or CHANGE=STRENGTH, as stiffness_change=5%\n", text));
      return kUsage;
    }
    demands.push_back(*demand);
    names.push_back(demand->name);
  }
  const bool known = AreNames(names, "--see", *registry);
  if (!AreNames(arguments.effects, "--effects", *registry) || !known) return kUsage;
  for (const std::string& kind : arguments.without) {
    if (kind == "record" || registry->FindCheck(kind) != nullptr) continue;
    Complain(fmt::format("--without: there is no kind of check \"{}\"; dynoproof list has them\n", kind));
    return kUsage;
  }
  if (!CanWrite({arguments.html, arguments.common.json, arguments.resume, arguments.write})) return kBroken;
  Kept kept(arguments.resume);
  if (!kept.Open(KeyOf(*prepared, arguments))) return kUsage;

  const Interruption interruption(arguments.common, [&arguments] {
    return arguments.resume.empty()
               ? std::string("nothing is kept: --resume FILE would keep what is found")
               : fmt::format("what was found is in {}: the same command goes on", arguments.resume);
  });
  probe::Options options{
      .without = arguments.without, .effects = arguments.effects, .threads = static_cast<unsigned>(arguments.jobs)};
  // A change that --see asks about is probed although --effects does not name it.
  if (!options.effects.empty()) options.effects.insert(options.effects.end(), names.begin(), names.end());
  options.known = kept.findings;
  options.found = [&](const probe::Finding& finding, std::size_t done, std::size_t all) {
    kept.Add(finding);
    ShowProgress(fmt::format("{} of {} changes: {}@{}", done, all, finding.name, finding.place),
                 static_cast<double>(done) / static_cast<double>(all));
  };
  const Result<probe::Probed> probed = probe::Probe(*prepared, options);
  ClearProgress();
  if (!probed.ok()) {
    Complain(probed.failure().ToString() + "\n");
    return probed.failure().exit_code;
  }
  if (!kept.Good()) {
    Complain(arguments.resume + ": cannot be written\n");
    return kBroken;
  }
  nlohmann::json findings = nlohmann::json::array(), asked = nlohmann::json::array();
  for (const probe::Finding& one : probed->findings) findings.push_back(probe::ToJson(one));
  std::string text = prepared->plan.id + ": " + probe::ToTable(*probed);
  nlohmann::json proposals = nlohmann::json::array();
  if (const int written = SayProposals(arguments, *prepared, *probed, text, proposals); written != kGood)
    return written;
  const bool met = Meets(demands, *probed, text, asked);
  Print(arguments.common, text);
  KeepJson({{"id", prepared->plan.id},
            {"sentence", probe::Sentence(*probed)},
            {"asked", probed->asked},
            {"not_asked", probed->skipped},
            {"limits", findings},
            {"proposals", proposals},
            {"demands", asked},
            {"runs", probed->runs}});
  if (!arguments.html.empty()) {
    const int written = WriteHtml(arguments.html, reports::ProbePage(prepared->plan.id, *probed));
    if (written != kGood) return written;
  }
  return met ? kGood : kShort;
}

}  // namespace

void AddProbe(Command program) {
  auto arguments = std::make_shared<ProbeArguments>();
  Command command = program.Subcommand("probe", "what the checks of a scenario would not see");
  command.Describe(
      "What the checks of a scenario would not see: every effect at every place, turned signs and dropped terms, each "
      "at the\n"
      "strength from which a check fails. Checks whose reference comes from the same plan (solvers, oracle) are not "
      "asked.");
  command.Value("scenario", arguments->scenario, "id or file").Required();
  command.Value("--set", arguments->overrides, "KEY=VALUE: override any key by its dotted path").OneWord();
  command
      .Value("--without", arguments->without,
             "kinds of checks that are not asked, or record; golden: what a wrong run would hide once it is blessed")
      .SplitAtCommas();
  command.Value("--effects", arguments->effects, "these changes alone").SplitAtCommas();
  command.Value("--see", arguments->see, "CHANGE[=STRENGTH]: exit 1 unless it is seen wherever it can be").OneWord();
  command.Value("--jobs", arguments->jobs, "runs at a time (default: one a core)").Within(1, 1024);
  command.Value("--resume", arguments->resume, "keep findings in this file as they come, and go on from there")
      .NamesFile();
  command.Value("--write", arguments->write, "write the lines of TOML that would see what passes").NamesFile();
  command.Value("--html", arguments->html, "write the page: a map of changes over places").NamesFile();
  AddCommon(command, arguments->common);
  command.Examples(
      "  dynoproof probe r2r/soft_rotor_setup_1\n"
      "  dynoproof probe line.toml --without golden --html out/probe.html\n"
      "  dynoproof probe line.toml --see stiffness_change=5% --see turned_sign");
  command.Runs([arguments] { return Probe(*arguments); });
}

}  // namespace dynoproof::app
