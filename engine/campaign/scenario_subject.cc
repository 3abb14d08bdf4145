#include "campaign/scenario_subject.h"

#include <algorithm>
#include <filesystem>
#include <limits>
#include <set>

#include "base/text.h"
#include "experiment/prepare.h"
#include "experiment/run_scenario.h"
#include "scenario/find.h"
#include "scenario/load.h"
#include "score/share.h"
#include "sim/batch.h"
#include "trace/trace_io.h"

namespace dynoproof::campaign {
namespace {

namespace fs = std::filesystem;

/// Up to here a batch was seen to pay (bench/batch_bench, README.md): beyond, "always" asks for it.
constexpr int kMostPairs = 71;

/// The first error of a collection in one line.
std::string FirstError(const Diagnostics& diagnostics) {
  for (const Diagnostic& item : diagnostics.items()) {
    if (item.severity == Diagnostic::Severity::kError)
      return item.message + (item.hint.empty() ? "" : " (" + item.hint + ")");
  }
  return "";
}

class ScenarioSubject : public Subject {
 public:
  ScenarioSubject(ScenarioOptions options, const Axes& axes, const Registry& registry, Plan plan)
      : options_(std::move(options)), axes_(axes), registry_(registry), plan_(std::move(plan)) {}

  const std::vector<FigureInfo>& figures() const override { return figures_; }

  int batch() const override { return batched_.empty() ? 1 : mechanics::BatchPropagator::kLanes; }

  Status Run(Range runs, bool one_by_one, const std::function<void(Row)>& done) const override {
    if (!batched_.empty()) {
      const std::int64_t lanes = one_by_one ? 1 : batch();
      for (std::int64_t run = runs.begin; run < runs.end; run += lanes)
        RunBatch({run, std::min(run + lanes, runs.end)}, done);
      return {};
    }
    for (std::int64_t run = runs.begin; run < runs.end; ++run) {
      Result<Row> row = RunOne(run);
      if (!row.ok()) return row.failure();
      done(*std::move(row));
    }
    return {};
  }

  std::string Command(std::int64_t run) const override {
    std::string command = "dynoproof run " + ShellQuoted(plan_.file);
    const auto add = [&command](const std::string& change) { command += " --set " + ShellQuoted(change); };
    for (const std::string& change : options_.set) add(change);
    for (std::size_t i = 0; i < axes_.size(); ++i) {
      add(axes_.spec(i).key + "=" + TextOf(axes_.At(i, run)));
    }
    if (options_.vary_seed) add(fmt::format("run.seed={}", axes_.Seed(run)));
    return command;
  }

  /// The plan of a run.
  Plan Varied(std::int64_t run) const {
    Plan plan = plan_;
    plan.id = fmt::format("run_{:09}", run);
    for (std::size_t i = 0; i < axes_.size(); ++i) {
      Value& place = *plan.root.FindPath(axes_.spec(i).key);
      Value value = axes_.At(i, run);
      // A list's 2 for the scenario's 2.0 is what a person writes.
      if (place.is_number() && !place.is_integer() && value.is_integer()) value = Value(value.number());
      value.set_where(place.where());
      place = std::move(value);
    }
    if (options_.vary_seed) plan.root["run"]["seed"] = Value(axes_.Seed(run));
    return plan;
  }

  /// Builds the corners of the campaign: what is wrong with them, by axis.
  void TryCorners(const Value& keys, Diagnostics& diagnostics) const {
    std::set<std::int64_t> tried;
    for (std::size_t i = 0; i < axes_.size(); ++i) {
      for (const std::int64_t run : axes_.Extremes(i)) {
        if (!tried.insert(run).second) continue;
        if (tried.size() > kMostCorners) return;
        Diagnostics found;
        if (Prepare(Varied(run), {}, registry_, found) != nullptr) continue;
        diagnostics.Error(
            keys.array()[i].where(),
            fmt::format("run {}, {} = {:.6g}: {}", run, axes_.spec(i).key, axes_.Number(i, run), FirstError(found)),
            "narrow the axis");
        break;
      }
    }
  }

  /// Names and units of the figures; needs the scenario to be right.
  void FindFigures(Diagnostics& diagnostics) {
    const std::unique_ptr<Prepared> prepared = Prepare(Varied(0), {}, registry_, diagnostics);
    if (prepared == nullptr) return;
    std::vector<std::string> names;
    for (const InputLine& line : prepared->rig->inputs) names.push_back(line.name);
    for (const OutputLine& line : prepared->rig->outputs) names.push_back(line.name);
    for (const auto& [name, spec] : options_.figures) {
      std::string unit = "1";
      if (const int output = FindOutput(*prepared->rig, spec.of); output >= 0) {
        unit = prepared->rig->outputs[static_cast<std::size_t>(output)].unit;
      } else if (const int input = FindInput(*prepared->rig, spec.of); input >= 0) {
        unit = prepared->rig->inputs[static_cast<std::size_t>(input)].unit;
      } else if (!spec.of.empty()) {
        const auto near = Closest(spec.of, names);
        const Value* place = options_.root.FindPath("figure." + name);
        diagnostics.Error(
            place != nullptr ? place->where() : SourceSpan{}, fmt::format("the scenario has no signal \"{}\"", spec.of),
            near ? fmt::format("did you mean \"{}\"?", *near) : fmt::format("it has {}", fmt::join(names, ", ")));
      }
      figures_.push_back({name, UnitOf(spec, unit), spec.at_least, spec.at_most});
    }
    ChooseBatches(*prepared->rig);
  }

 private:
  static constexpr std::size_t kMostCorners = 64;  // each costs as much as a run's preparation

  /// Batches are for plain figures of plain linear plants; by the first run, so that all rows take the same way.
  void ChooseBatches(const Rig& rig) {
    if (options_.batch == "never" || !options_.checks.empty() || options_.keep_traces != "none") return;
    const Result<BatchMember> member = BatchMember::Create(rig);
    if (!member.ok() || (options_.batch == "auto" && member->pairs() > kMostPairs)) return;
    std::set<int> outputs;
    for (const auto& [name, spec] : options_.figures) {
      if (!spec.from.empty()) return;
      if (const int output = FindOutput(rig, spec.of); output >= 0) outputs.insert(output);
    }
    if (outputs.size() > 4) return;
    batched_.assign(outputs.begin(), outputs.end());
    same_inputs_ = !options_.vary_seed;
    for (std::size_t i = 0; i < axes_.size(); ++i)
      same_inputs_ = same_inputs_ && axes_.spec(i).key.starts_with("plant.");
  }

  /// The runs side by side. A run that no batch takes is made alone, whatever its neighbours are.
  void RunBatch(Range runs, const std::function<void(Row)>& done) const {
    struct Lane {
      std::unique_ptr<Prepared> prepared;
      std::unique_ptr<BatchMember> member;
    };
    std::vector<Lane> lanes(static_cast<std::size_t>(runs.size()));
    std::vector<const BatchMember*> members;
    for (std::size_t i = 0; i < lanes.size(); ++i) {
      Diagnostics ignored;  // RunOne() will report them
      lanes[i].prepared = Prepare(Varied(runs.begin + static_cast<std::int64_t>(i)), {}, registry_, ignored);
      if (lanes[i].prepared == nullptr) continue;
      Result<BatchMember> member = BatchMember::Create(*lanes[i].prepared->rig);
      if (!member.ok()) continue;
      lanes[i].member = std::make_unique<BatchMember>(*std::move(member));
      members.push_back(lanes[i].member.get());
    }
    Result<std::vector<Samples>> all = Failure{};
    if (!members.empty()) all = SimulateBatch(members, batched_, same_inputs_);
    std::size_t next = 0;
    for (std::size_t i = 0; i < lanes.size(); ++i) {
      const std::int64_t run = runs.begin + static_cast<std::int64_t>(i);
      Result<Row> row = Failure{};
      if (lanes[i].member != nullptr) {
        const BatchMember* const self = lanes[i].member.get();
        if (!all.ok()) {  // variants that differ in more than numbers: each in a batch of its own
          Result<std::vector<Samples>> alone = SimulateBatch({&self, 1}, batched_, same_inputs_);
          if (alone.ok()) row = RowOf(run, *lanes[i].prepared, alone->front());
        } else {
          row = RowOf(run, *lanes[i].prepared, (*all)[next++]);
        }
      }
      if (!row.ok()) row = RunOne(run);
      if (row.ok()) done(*std::move(row));
    }
  }

  Row RowOf(std::int64_t run, const Prepared& prepared, const Samples& samples) const {
    Row row;
    row.run = run;
    row.figures.assign(options_.figures.size(), std::numeric_limits<double>::quiet_NaN());
    for (const int output : batched_) {
      const std::vector<double>& values = samples.outputs[static_cast<std::size_t>(output)];
      const auto bad = std::ranges::find_if(values, [](double value) { return !std::isfinite(value); });
      if (bad == values.end()) continue;
      row.verdict = score::Verdict::kBroken;
      row.why = Failure{"not a finite number", "output." + prepared.rig->outputs[static_cast<std::size_t>(output)].name,
                        samples.time[static_cast<std::size_t>(bad - values.begin())]}
                    .ToString();
      return row;
    }
    TakeFigures(prepared, samples, {}, row);
    return row;
  }

  Result<Row> RunOne(std::int64_t run) const {
    Row row;
    row.run = run;
    row.figures.assign(options_.figures.size(), std::numeric_limits<double>::quiet_NaN());
    Diagnostics diagnostics;
    const std::unique_ptr<Prepared> prepared = Prepare(Varied(run), {}, registry_, diagnostics);
    if (prepared == nullptr) {
      row.verdict = score::Verdict::kBroken;
      row.why = FirstError(diagnostics);
      return row;
    }
    Status lost;
    RunOptions options;
    options.out = "";
    options.seen = [&](const Course& course, const ScenarioResult& result) {
      TakeFigures(*prepared, course.samples, result, row);
      const bool wanted =
          options_.keep_traces == "all" || (options_.keep_traces == "failing" && row.verdict != score::Verdict::kPass);
      if (wanted) lost = trace::WriteTrace(fs::path(options_.traces) / (prepared->plan.id + ".h5"), course.trace);
    };
    const ScenarioResult result = RunScenario(*prepared, options);
    if (lost) return *lost;
    if (result.verdict == score::Verdict::kBroken && row.why.empty()) {
      row.verdict = score::Verdict::kBroken;
      row.why = result.broken.empty() ? "a check broke" : result.broken;
    }
    return row;
  }

  /// Figures, and the verdict over checks and limits.
  void TakeFigures(const Prepared& prepared, const Samples& samples, const ScenarioResult& result, Row& row) const {
    using score::Verdict;
    bool judged = !result.checks.empty();
    row.verdict = judged ? score::Combine(result.checks) : Verdict::kPass;
    for (const score::Check& check : result.checks) {
      row.Takes(score::ShareOfLimit(check),
                fmt::format("{}: {:.6g}, limit {:.6g}", check.name, check.value, check.limit));
      if (check.verdict == Verdict::kPass || !row.why.empty()) continue;
      row.why = check.name + ": " +
                (check.explanation.empty()
                     ? fmt::format("{:.6g}, {} {:.6g}", check.value, check.at_least ? "at least" : "limit", check.limit)
                     : check.explanation);
    }
    for (std::size_t i = 0; i < options_.figures.size(); ++i) {
      const auto& [name, spec] = options_.figures[i];
      if (!spec.of.empty()) {
        row.figures[i] = Take(spec, SeriesOf(samples, *prepared.rig, spec.of));
      } else if (const auto found = result.figures.find(spec.from); found != result.figures.end()) {
        row.figures[i] = found->second.value;
      }
      judged = judged || spec.limited();
      row.Takes(spec.Used(row.figures[i]), spec.Limits(name, row.figures[i]));
      const std::string fault = spec.Fault(name, row.figures[i]);
      if (fault.empty()) continue;
      row.verdict = score::Worse(row.verdict, Verdict::kFail);
      if (row.why.empty()) row.why = fault;
    }
    if (!judged) {
      row.verdict = Verdict::kInconclusive;
      row.why = "no limit and no check: nothing was judged";
    }
  }

  ScenarioOptions options_;
  const Axes& axes_;
  const Registry& registry_;
  Plan plan_;
  std::vector<FigureInfo> figures_;
  std::vector<int> batched_;  // outputs that batches give; empty: runs are made one by one
  bool same_inputs_ = false;
};

/// Every axis must name a value of the scenario: `run` would not let --set make up a key either.
void FindKeys(const std::string& file, const ScenarioOptions& options, Axes& axes, Plan& plan,
              Diagnostics& diagnostics) {
  for (std::size_t i = 0; i < axes.size(); ++i) {
    const AxisSpec& spec = axes.spec(i);
    const SourceSpan where = options.root.Find("axis")->array()[i].where();
    const Value* value = plan.root.FindPath(spec.key);
    if (value != nullptr && value->is_number()) {
      axes.SetNominal(i, value->number());
    } else if (spec.relative) {
      diagnostics.Error(where,
                        fmt::format("axis {}: the scenario has no number of this name to be relative to", spec.key),
                        "give absolute values, or set = [\"" + spec.key + "=VALUE\"]");
      continue;
    }
    if (value != nullptr && value->is_number() && !axes.Labels(i).empty()) {
      diagnostics.Error(where, fmt::format("axis {}: the scenario has a number there, the axis texts", spec.key));
      continue;
    }
    // A key that is not written may still be one that can be set: the loader decides, as for --set.
    Diagnostics found;
    std::vector<std::string> all = options.set;
    all.push_back(spec.key + "=" + TextOf(axes.At(i, 0)));
    std::optional<Plan> tried = LoadPlan(file, all, found);
    for (const Diagnostic& item : found.items()) {
      if (item.severity == Diagnostic::Severity::kError)
        diagnostics.Error(where, fmt::format("axis {}: {}", spec.key, item.message), item.hint);
    }
    if (found.has_errors() || !tried || value != nullptr) continue;
    MergeInto(plan.root, tried->root);  // now the key is there in every plan of the campaign
  }
}

/// Leaves the checks of the kinds that are asked for.
void KeepChecks(const ScenarioOptions& options, Plan& plan, Diagnostics& diagnostics) {
  const auto kind_of = [](const Value& check) {
    const Value* kind = check.Find("kind");
    return kind != nullptr && kind->is_string() ? kind->string() : std::string();
  };
  std::set<std::string> kept;
  if (Value* checks = plan.root.Find("check"); checks != nullptr && checks->is_array()) {
    std::erase_if(checks->array(), [&](const Value& check) {
      const bool wanted = std::ranges::count(options.checks, kind_of(check)) > 0;
      if (wanted) kept.insert(kind_of(check));
      return !wanted;
    });
    if (checks->array().empty()) plan.root.Erase("check");
  }
  for (const std::string& kind : options.checks) {
    if (kept.contains(kind)) continue;
    diagnostics.Error(options.root.Find("checks")->where(),
                      fmt::format("the scenario has no check of kind \"{}\"", kind));
  }
}

}  // namespace

std::unique_ptr<Subject> MakeScenarioSubject(ScenarioOptions options, Axes& axes, const Registry& registry,
                                             std::string& text, Diagnostics& diagnostics) {
  const int before = diagnostics.error_count();
  const SourceSpan where = options.root.Find("scenario")->where();
  const fs::path beside = fs::path(options.folder) / options.scenario;
  std::error_code error;
  Diagnostics found;
  const std::vector<std::string> files = fs::is_regular_file(beside, error) ? std::vector<std::string>{beside.string()}
                                                                            : FindScenarios(options.scenario, found);
  for (const Diagnostic& item : found.items())
    diagnostics.Error(where, fmt::format("\"{}\": {}", options.scenario, item.message), item.hint);
  if (files.size() > 1)
    diagnostics.Error(where, fmt::format("\"{}\" names {} scenarios", options.scenario, files.size()), "name one");
  if (diagnostics.error_count() != before) return nullptr;
  std::optional<Plan> plan = LoadPlan(files.front(), options.set, diagnostics);
  if (!plan || diagnostics.error_count() != before) return nullptr;
  FindKeys(files.front(), options, axes, *plan, diagnostics);
  if (diagnostics.error_count() != before) return nullptr;
  KeepChecks(options, *plan, diagnostics);
  if (diagnostics.error_count() != before) return nullptr;
  text = ToToml(plan->root);
  const Value root = options.root;
  auto subject = std::make_unique<ScenarioSubject>(std::move(options), axes, registry, *std::move(plan));
  if (const Value* keys = root.Find("axis")) subject->TryCorners(*keys, diagnostics);
  if (diagnostics.error_count() == before) subject->FindFigures(diagnostics);
  return diagnostics.error_count() == before ? std::move(subject) : nullptr;
}

}  // namespace dynoproof::campaign
