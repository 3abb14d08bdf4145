#include "experiment/run_scenario.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <filesystem>
#include <limits>

#include "base/cpu.h"
#include "experiment/analysis.h"
#include "experiment/build_info.h"
#include "experiment/golden.h"
#include "experiment/kept_reference.h"
#include "experiment/measured_record.h"
#include "experiment/moved_modes.h"
#include "experiment/prediction_windows.h"
#include "scenario/load.h"
#include "score/hull.h"
#include "sim/solver.h"
#include "trace/trace_io.h"

namespace dynoproof {
namespace {

/// Adds the hull curves of the analysed output, one point per window, as signals of a time base of their own.
void AddHull(const Prepared& prepared, trace::Trace& trace) {
  Diagnostics ignored;  // Prepare() has reported them
  const std::optional<AnalysisSettings> settings = ReadAnalysis(prepared.plan, *prepared.rig, ignored);
  if (!settings) return;
  const trace::Signal* signal = trace.Find(settings->output);
  const score::HullCurve hull = score::Hull({trace.time, signal->values}, settings->hull_window_s);
  if (!hull.ok()) return;
  std::vector<double> time, upper, lower;
  double next = trace.time.front();
  for (std::size_t i = 0; i < hull.time_s.size(); ++i) {
    if (hull.time_s[i] < next) continue;
    time.push_back(hull.time_s[i]);
    upper.push_back(hull.upper[i]);
    lower.push_back(hull.lower[i]);
    next += settings->hull_window_s;
  }
  const std::string unit = signal->unit;
  const double nominal = signal->nominal;
  trace.other_times.push_back(std::move(time));
  for (auto& [name, values] : {std::pair("hull_upper", &upper), std::pair("hull_lower", &lower)}) {
    trace.signals.push_back({settings->output + "_" + name, unit, "hull curve of " + settings->output, nominal,
                             trace::Interpolation::kLinear, std::move(*values), trace.other_times.size()});
  }
}

/// Adds the outputs of every [variant.NAME], each as OUTPUT_NAME, so that one trace holds them all; or those alone that
/// it keeps.
Status AddVariants(const Prepared& prepared, trace::Trace& trace) {
  for (const Prepared::Variant& variant : prepared.variants) {
    const Rig& rig = *variant.rig;
    const Value* const keep = prepared.plan.root.Find("variant")->Find(variant.name)->Find("keep");
    const Result<std::unique_ptr<Solver>> solver = MakeSolver(rig.run.solver, rig);
    if (!solver.ok()) return solver.failure();
    Result<Samples> samples = Simulate(rig, **solver);
    if (!samples.ok()) return samples.failure();
    std::size_t base = 0;
    if (samples->time != trace.time) {
      trace.other_times.push_back(samples->time);
      base = trace.other_times.size();
    }
    for (std::size_t i = 0; i < rig.outputs.size(); ++i) {
      const OutputLine& line = rig.outputs[i];
      const auto is_it = [&line](const Value& name) { return name.string() == line.name; };
      if (keep != nullptr && std::none_of(keep->array().begin(), keep->array().end(), is_it)) continue;
      trace.signals.push_back({line.name + "_" + variant.name, line.unit, line.description + ", " + variant.name,
                               line.nominal, trace::Interpolation::kLinear, std::move(samples->outputs[i]), base});
    }
  }
  return {};
}

/// The comparison with a record in windows (prediction_window_s): what was predicted, and the record's rows from the
/// second window on. The trace gets the predictions as OUTPUT_windows.
struct Windowed {
  Samples samples;
  MappedRecord data;
};
Result<Windowed> CompareInWindows(const Rig& rig, const MappedRecord& data, double window_s, trace::Trace& trace) {
  const Result<Observer> observer = MakeObserver(rig, data, window_s);
  if (!observer.ok()) return observer.failure();
  const Result<std::unique_ptr<Solver>> solver = MakeSolver("realtime", rig);
  if (!solver.ok()) return solver.failure();
  Result<Samples> samples = PredictInWindows(rig, **solver, *observer);
  if (!samples.ok()) return samples.failure();
  Windowed windowed{std::move(*samples), data};
  for (auto& [name, series] : windowed.data.outputs) {
    series = From(series, window_s);
    const OutputLine& line = rig.outputs[static_cast<std::size_t>(FindOutput(rig, name))];
    trace.signals.push_back({name + "_windows", line.unit, line.description + ", predicted in windows", line.nominal,
                             trace::Interpolation::kLinear,
                             windowed.samples.outputs[static_cast<std::size_t>(FindOutput(rig, name))]});
  }
  return windowed;
}

}  // namespace

trace::Provenance BuildProvenance() {
  trace::Provenance provenance;
  provenance.Set("version", build_info::kVersion);
  provenance.Set("commit", build_info::Commit());
  provenance.Set("compiler", build_info::kCompiler);
  provenance.Set("cpu", CpuFeatureClass());
  return provenance;
}

namespace {

/// "soft_stop.so sha256 3f2a..., ...": shared libraries whose code may be in a run; empty where there are none.
std::string LibrariesOf(const Registry& registry) {
  std::string text;
  for (const std::string& file : registry.libraries())
    text += fmt::format("{}{} sha256 {}", text.empty() ? "" : ", ", std::filesystem::path(file).filename().string(),
                        HashOf(file));
  return text;
}

}  // namespace

trace::Trace SampledTrace(const Rig& rig, const Samples& samples) {
  trace::Trace trace;
  trace.time = samples.time;
  for (std::size_t i = 0; i < rig.inputs.size(); ++i) {
    const InputLine& line = rig.inputs[i];
    // The output of a continuous part changes between ticks; any other input is held.
    const auto between = line.continuous ? trace::Interpolation::kLinear : trace::Interpolation::kHold;
    trace.signals.push_back({line.name, line.unit, line.description, line.nominal, between, samples.inputs[i]});
  }
  for (std::size_t i = 0; i < rig.outputs.size(); ++i) {
    const OutputLine& line = rig.outputs[i];
    trace.signals.push_back(
        {line.name, line.unit, line.description, line.nominal, trace::Interpolation::kLinear, samples.outputs[i]});
  }
  return trace;
}

trace::Trace MakeTrace(const Prepared& prepared, const Samples& samples) {
  const Rig& rig = *prepared.rig;
  trace::Trace trace = SampledTrace(rig, samples);
  AddHull(prepared, trace);
  trace.scenario = ToToml(prepared.plan.root);
  trace.provenance = BuildProvenance();
  trace.provenance.Set("solver", rig.run.solver);
  trace.provenance.Set("solver_summary", samples.solver_summary);
  if (const std::string plugins = LibrariesOf(*prepared.registry); !plugins.empty())
    trace.provenance.Set("plugins", plugins);
  trace.provenance.SetCounter("seed", rig.run.seed);
  for (const auto& [name, count] : samples.counters) trace.provenance.SetCounter("solver_" + name, count);
  return trace;
}

Result<Course> Play(const Prepared& prepared, const Progress& progress, bool timed) {
  const Rig& rig = *prepared.rig;
  const Result<std::unique_ptr<Solver>> solver = MakeSolver(rig.run.solver, rig);
  if (!solver.ok()) return solver.failure();
  StepTimes times;
  Result<Samples> samples = Simulate(rig, **solver, progress, timed ? &times : nullptr);
  if (!samples.ok()) return samples.failure();
  trace::Trace trace = MakeTrace(prepared, *samples);
  if (Status failed = AddVariants(prepared, trace)) return *failed;
  return Course{std::move(*samples), std::move(trace), times};
}

namespace {

/// The result of a scenario whose [record] cannot be read: one failed check, no run.
ScenarioResult WithoutRecord(const Prepared& prepared, ScenarioResult result) {
  score::Check& check = result.checks.emplace_back();
  check.name = "record";
  check.kind = "record";
  check.explanation = prepared.record_fault;
  check.value = check.limit = std::numeric_limits<double>::quiet_NaN();
  check.shown = "not run: the record is not there as [record] has it";
  check.origin = "file and hash of [record]";
  result.verdict = score::Combine(result.checks);
  return result;
}

struct Simulated {
  Course course;
  std::optional<Windowed> windowed = {};
};

/// Simulates the scenario, and once more in windows of the record where the scenario asks for it.
Result<Simulated> SimulateBeside(const Prepared& prepared, const RunOptions& options, const MappedRecord* data,
                                 std::vector<std::string>& notes) {
  Result<Course> course = Play(prepared, options.progress, options.seen != nullptr);
  if (!course.ok()) return course.failure();
  Simulated simulated{std::move(*course)};
  const std::optional<double> window_s = PredictionWindow(prepared.plan);
  if (data == nullptr || !window_s || data->outputs.empty()) return simulated;
  Result<Windowed> windowed = CompareInWindows(*prepared.rig, *data, *window_s, simulated.course.trace);
  if (!windowed.ok()) return windowed.failure();
  simulated.windowed = std::move(*windowed);
  notes.push_back(fmt::format(
      "compared in windows of {} s, each from a state that the record before it tells (OUTPUT_windows of the trace)",
      *window_s));
  return simulated;
}

/// The scenario's own checks, its golden trace among them.
void CheckCourse(const Prepared& prepared, const RunOptions& options, const Course& course, ScenarioResult& result) {
  CheckContext context(prepared.plan, *prepared.rig, course.samples, prepared.rig->run.solver);
  context.trace = &course.trace;
  context.registry = prepared.registry;
  context.records = prepared.records.get();
  context.golden = &prepared.golden;
  std::optional<KeptReference> kept;
  if (!options.kept.empty()) context.kept = &kept.emplace(options.kept, prepared);
  result.checks = RunChecks(prepared.checks, context);
  // Checks that --set gives in place of the scenario's own are asked for alone.
  std::optional<score::Check> gone;
  if (prepared.checks_as_written) gone = GoldenNotStated(prepared.golden, prepared.plan);
  if (gone) result.checks.push_back(std::move(*gone));
  result.figures = std::move(context.figures);
  if (!context.kept_note.empty()) result.notes.push_back(std::move(context.kept_note));
}

/// The comparison with the record: alone where a command names it, beside the scenario's checks where the scenario does.
void CompareWithData(const Prepared& prepared, const RunOptions& options, const Simulated& simulated,
                     const MappedRecord& data, ScenarioResult& result) {
  result.notes.insert(result.notes.end(), data.notes.begin(), data.notes.end());
  const RecordSettings settings = prepared.record.value_or(RecordSettings());
  const std::string today = options.today.empty() ? Today() : options.today;
  const std::optional<Windowed>& windowed = simulated.windowed;
  std::vector<score::Check> compared =
      CompareWithRecord(*prepared.rig, windowed ? windowed->samples : simulated.course.samples,
                        windowed ? windowed->data : data, settings, today, result.figures);
  if (compared.empty()) result.notes.push_back("the record has no output of the scenario: nothing was compared");
  if (options.data != nullptr) result.checks.clear();
  result.checks.insert(result.checks.end(), compared.begin(), compared.end());
}

}  // namespace

ScenarioResult RunScenario(const Prepared& prepared, const RunOptions& options) {
  ScenarioResult result;
  result.id = prepared.plan.id;
  result.title = prepared.title;
  result.notes = prepared.notes;
  if (!prepared.changes.empty())
    result.changes.push_back(fmt::format("by --set: {}", fmt::join(prepared.changes, ", ")));
  if (!prepared.record_fault.empty()) return WithoutRecord(prepared, std::move(result));
  const auto broken = [&result](const Failure& failure) {
    result.verdict = score::Verdict::kBroken;
    result.broken = failure.ToString();
    result.exit_code = failure.exit_code;
    return result;
  };
  const MappedRecord* const data = options.data != nullptr ? options.data : prepared.data.get();
  const Result<Simulated> simulated = SimulateBeside(prepared, options, data, result.notes);
  if (!simulated.ok()) return broken(simulated.failure());
  const Course& course = simulated->course;
  result.counters = course.samples.counters;
  const std::string base = (std::filesystem::path(options.out) / result.id).string();
  if (!options.out.empty()) {
    if (Status failed = trace::WriteTrace(base + ".h5", course.trace)) return broken(*failed);
    result.trace_file = base + ".h5";
  }

  CheckCourse(prepared, options, course, result);
  if (data != nullptr) {
    CompareWithData(prepared, options, *simulated, *data, result);
  } else if (result.checks.empty()) {
    result.notes.push_back("the scenario states no checks: nothing was compared");
  }
  const bool fell_short = std::any_of(result.checks.begin(), result.checks.end(), [](const score::Check& check) {
    return IsOfGolden(check) && check.verdict != score::Verdict::kPass;
  });
  if (fell_short && prepared.changes.empty()) {
    constexpr std::size_t kSaid = 5;
    std::vector<std::string> since = ChangedSinceBlessed(prepared.golden, prepared.plan);
    const std::size_t more = since.size() - std::min(kSaid, since.size());
    since.resize(since.size() - more);
    if (!since.empty())
      result.changes.push_back(fmt::format("since it was blessed: {}{}", fmt::join(since, ", "),
                                           more > 0 ? fmt::format(" and {} more", more) : ""));
  }
  if (fell_short) {
    if (std::string moved = MovedModes(prepared); !moved.empty()) result.changes.push_back(std::move(moved));
  }
  if (!options.out.empty()) {
    const Result<std::string> note = KeepGolden(prepared.golden, fell_short, base + ".h5", base + ".golden.h5");
    if (!note.ok()) return broken(note.failure());
    if (!note->empty()) result.notes.push_back(*note);
  }
  const bool inputs_alone = data != nullptr && result.checks.empty();
  result.verdict = inputs_alone ? score::Verdict::kInconclusive : score::Combine(result.checks);
  if (options.seen) options.seen(course, result);
  // The evidence is as long as the run; results of many scenarios are kept side by side.
  for (score::Check& check : result.checks) check.evidence = nullptr;
  return result;
}

}  // namespace dynoproof
