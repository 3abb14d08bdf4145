#include "campaign/campaign.h"

#include <algorithm>
#include <filesystem>
#include <map>

#include "base/text.h"
#include "campaign/command_subject.h"
#include "campaign/scenario_subject.h"
#include "experiment/build_info.h"
#include "scenario/load.h"

namespace dynoproof::campaign {
namespace {

namespace fs = std::filesystem;

constexpr std::int64_t kMostRuns = 100'000'000;

std::map<std::string, StudyMaker>& Studies() {
  static std::map<std::string, StudyMaker> studies;
  return studies;
}

std::vector<std::string> StudyNames() {
  std::vector<std::string> names;
  for (const auto& [name, maker] : Studies()) names.push_back(name);
  return names;
}

/// The campaign file.
struct Spec {
  std::string title, scenario, diagnose, study, sampling = "random", keep_traces = "none", batch = "auto";
  std::vector<std::string> set, checks, command, data, map, holdout;
  std::vector<Value> axis;
  std::vector<std::pair<std::string, Value>> parameters;
  std::vector<std::pair<std::string, FigureSpec>> figure;
  std::vector<std::pair<std::string, RateSpec>> rate;
  Value slurm;
  std::int64_t samples = 1, seed = 1;
  bool vary_seed = true;
  double most_failing = 0.0, most_seconds = 0.0;
  void Visit(auto& v) {
    v.Required("title", title, Any(), "what the campaign is to find out");
    v.Optional("scenario", scenario, Any(), "what is run: a scenario by id or file");
    v.Optional("diagnose", diagnose, Any(), "instead: a scenario that is held against records, by id or file");
    v.Optional("data", data, Any(), "records of diagnose; {KEY} stands for an axis");
    v.Optional("map", map, Any(), "their maps");
    v.Optional("holdout", holdout, Any(), "its hold-out records");
    v.Optional("study", study, StudyNames(), "instead: a study of the engine");
    v.Optional("command", command, Any(), "instead: a program and its arguments, {KEY} standing for an axis");
    v.Optional("parameters", parameters, Any(), "values of the study for all runs");
    v.Optional("set", set, Any(), "KEY=VALUE changes of the scenario for all runs");
    v.Optional("samples", samples, Between(0, static_cast<double>(kMostRuns)), "draws at each point of the grid");
    v.Optional("sampling", sampling, std::vector<std::string>{"random", "latin_hypercube"}, "how axes are drawn");
    v.Optional("seed", seed, NonNegative(), "of all that is drawn");
    v.Optional("vary_seed", vary_seed, Any(), "each sample has a run.seed of its own");
    v.Optional("checks", checks, Any(), "kinds of the scenario's checks that are made in each run");
    v.Optional("keep_traces", keep_traces, std::vector<std::string>{"none", "failing", "all"}, "which traces stay");
    v.Optional("batch", batch, std::vector<std::string>{"auto", "always", "never"},
               "variants of a linear plant side by side in vector lanes: where it pays, wherever it can be, never");
    v.Optional("most_failing", most_failing, Between(0.0, 1.0), "share of failing runs that is accepted");
    v.Optional("most_seconds", most_seconds, NonNegative(), "a run that takes longer is broken; 0: no limit");
    v.Optional("axis", axis, Any(), "[[axis]]: what is varied");
    v.Optional("figure", figure, Any(), "[figure.NAME]: what is kept of a run");
    v.Optional("rate", rate, Any(), "[rate.NAME]: shares over all runs");
    v.Optional("slurm", slurm, Any(), "[slurm]: how array tasks are cut and watched");
  }
};

SourceSpan WhereIs(const Value& root, const char* key) {
  const Value* value = root.Find(key);
  return value != nullptr ? value->where() : root.where();
}

void CheckRates(const Campaign& campaign, const Value& root, Diagnostics& diagnostics) {
  std::vector<std::string> known = {"runs", "fail", "broken"}, axes;
  for (const FigureInfo& figure : campaign.subject->figures()) known.push_back(figure.name);
  for (std::size_t i = 0; i < campaign.axes.size(); ++i) axes.push_back(campaign.axes.spec(i).key);
  for (const auto& [name, rate] : campaign.rates) {
    for (const auto& [word, words] :
         {std::pair(&rate.hits, &known), std::pair(&rate.of, &known), std::pair(&rate.by, &axes)}) {
      if (std::ranges::count(*words, *word) > 0 || (word == &rate.by && word->empty())) continue;
      const auto near = Closest(*word, *words);
      diagnostics.Error(
          WhereIs(*root.Find("rate"), name.c_str()), fmt::format("rate {}: there is no \"{}\"", name, *word),
          near ? fmt::format("did you mean \"{}\"?", *near) : fmt::format("known: {}", fmt::join(*words, ", ")));
    }
  }
}

std::vector<AxisSpec> ReadAxes(const std::vector<Value>& tables, Diagnostics& diagnostics) {
  std::vector<AxisSpec> axes;
  for (const Value& table : tables) {
    AxisSpec& axis = axes.emplace_back();
    if (!table.is_table()) {
      diagnostics.Error(table.where(), "an axis is " + table.KindName(), "write [[axis]]");
      continue;
    }
    ReadParams(table, axis, diagnostics, "axis");
    for (std::size_t i = 0; i + 1 < axes.size(); ++i) {
      if (axes[i].key == axis.key)
        diagnostics.Error(table.where(), fmt::format("a second axis has the key \"{}\"", axis.key), "one axis a key");
    }
  }
  return axes;
}

std::int64_t RunsOf(const std::vector<AxisSpec>& axes, std::int64_t samples) {
  double runs = static_cast<double>(samples);
  for (const AxisSpec& axis : axes) {
    if (axis.drawn()) continue;
    runs *= axis.grid.empty() ? static_cast<double>(axis.list.size()) : axis.count;
  }
  return static_cast<std::int64_t>(std::min(runs, 9e18));
}

/// `dynoproof diagnose` as a program: what its records do not name of the axes changes the nominal scenario.
std::vector<std::string> DiagnoseCommand(const Spec& spec, const Axes& axes) {
  std::error_code error;
  std::vector<std::string> command = {fs::read_symlink("/proc/self/exe", error).string(), "diagnose", spec.diagnose};
  for (const auto& [option, files] : {std::pair("--data", &spec.data), std::pair("--map", &spec.map),
                                      std::pair("--holdout", &spec.holdout), std::pair("--set", &spec.set)}) {
    for (const std::string& file : *files) command.insert(command.end(), {option, file});
  }
  for (std::size_t i = 0; i < axes.size(); ++i) {
    const std::string place = "{" + axes.spec(i).key + "}";
    const bool named = std::any_of(command.begin(), command.end(),
                                   [&place](const std::string& word) { return word.find(place) != std::string::npos; });
    if (!named) command.insert(command.end(), {"--set", axes.spec(i).key + "=" + place});
  }
  command.insert(command.end(), {"--out", "{folder}", "--json", "-"});
  return command;
}

std::unique_ptr<Subject> MakeSubject(Spec& spec, const Value& root, const std::string& file, const std::string& folder,
                                     Axes& axes, const Registry& registry, std::string& text,
                                     Diagnostics& diagnostics) {
  if (!spec.study.empty()) return Studies().at(spec.study)(spec.parameters, root, axes, diagnostics);
  if (!spec.diagnose.empty()) spec.command = DiagnoseCommand(spec, axes);
  if (!spec.command.empty())
    return MakeCommandSubject(std::move(spec.command), std::move(spec.figure), root, axes, folder, diagnostics);
  ScenarioOptions options;
  options.scenario = spec.scenario;
  options.folder = fs::path(file).parent_path().string();
  options.set = std::move(spec.set);
  options.checks = std::move(spec.checks);
  options.figures = std::move(spec.figure);
  options.keep_traces = spec.keep_traces;
  options.traces = (fs::path(folder) / "traces").string();
  options.vary_seed = spec.vary_seed;
  options.batch = spec.batch;
  options.root = root;
  return MakeScenarioSubject(std::move(options), axes, registry, text, diagnostics);
}

}  // namespace

void AddStudy(const std::string& name, StudyMaker maker) { Studies()[name] = maker; }

std::unique_ptr<Campaign> LoadCampaign(const std::string& file, const std::string& folder, const Registry& registry,
                                       Diagnostics& diagnostics) {
  const int before = diagnostics.error_count();
  std::optional<Plan> plan = LoadPlan(file, {}, diagnostics);
  if (!plan) return nullptr;
  const Value& root = plan->root;
  Spec spec;
  ReadParams(root, spec, diagnostics, "campaign");
  const std::string* const names[] = {&spec.scenario, &spec.diagnose, &spec.study};
  const auto subjects =
      std::count_if(std::begin(names), std::end(names), [](const auto* name) { return !name->empty(); }) +
      (spec.command.empty() ? 0 : 1);
  if (!spec.diagnose.empty() && spec.data.empty())
    diagnostics.Error(WhereIs(root, "diagnose"), "there is no record to explain", "add data = [\"...\"]");
  if (subjects != 1) {
    diagnostics.Error(root.where(), fmt::format("the campaign names {} subjects", subjects),
                      "exactly one of scenario, diagnose, study, command");
  }
  auto campaign = std::make_unique<Campaign>();
  if (root.Find("slurm") != nullptr) {
    if (spec.slurm.is_table())
      ReadParams(spec.slurm, campaign->slurm, diagnostics, "slurm");
    else
      diagnostics.Error(spec.slurm.where(), "slurm is " + spec.slurm.KindName(), "write [slurm]");
  }
  std::vector<AxisSpec> axes = ReadAxes(spec.axis, diagnostics);
  if (diagnostics.error_count() != before) return nullptr;
  const std::int64_t runs = RunsOf(axes, spec.samples);
  if (runs == 0) diagnostics.Error(WhereIs(root, "samples"), "the campaign has no runs", "samples = 1 or more");
  if (runs > kMostRuns)
    diagnostics.Error(root.where(), fmt::format("the campaign has more than {} runs", kMostRuns), "coarser axes");
  if (diagnostics.error_count() != before) return nullptr;

  campaign->id = fs::path(file).stem().string();
  campaign->file = file;
  campaign->title = spec.title;
  campaign->most_failing = spec.most_failing;
  campaign->most_seconds = spec.most_seconds;
  campaign->rates = std::move(spec.rate);
  campaign->axes =
      Axes(std::move(axes), spec.samples, spec.sampling == "random" ? Sampling::kRandom : Sampling::kLatinHypercube,
           static_cast<std::uint64_t>(spec.seed));
  std::string subject_text;
  campaign->subject = MakeSubject(spec, root, file, folder, campaign->axes, registry, subject_text, diagnostics);
  if (campaign->subject == nullptr) return nullptr;
  CheckRates(*campaign, root, diagnostics);
  Value decisive = root;  // how tasks are cut decides no row
  decisive.Erase("slurm");
  campaign->text = ToToml(decisive);
  campaign->fingerprint =
      Fingerprint(campaign->text + subject_text + build_info::kVersion + std::string(build_info::Commit()));
  return diagnostics.error_count() == before ? std::move(campaign) : nullptr;
}

}  // namespace dynoproof::campaign
