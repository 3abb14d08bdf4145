#include "experiment/run_scenario.h"

#include <fmt/format.h>

#include <filesystem>

#include "base/cpu.h"
#include "experiment/analysis.h"
#include "experiment/build_info.h"
#include "experiment/why.h"
#include "scenario/load.h"
#include "score/hull.h"
#include "score/nrmse.h"
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

/// Adds the outputs of every [variant.NAME], each as OUTPUT_NAME, so that one trace holds them all.
Status AddVariants(const Prepared& prepared, trace::Trace& trace) {
  for (const Prepared::Variant& variant : prepared.variants) {
    const Rig& rig = *variant.rig;
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
      trace.signals.push_back({line.name + "_" + variant.name, line.unit, line.description + ", " + variant.name,
                               line.nominal, trace::Interpolation::kLinear, std::move(samples->outputs[i]), base});
    }
  }
  return {};
}

/// The outputs against a measured record, each at the record's own time stamps.
std::vector<score::Check> CompareWithRecord(const Prepared& prepared, const Samples& samples, const MappedRecord& data,
                                            Figures& figures) {
  std::vector<score::Check> checks;
  const Value* limits = prepared.plan.root.FindPath("record.nrmse");
  for (const auto& [name, series] : data.outputs) {
    score::NrmseOptions options;
    const Value* limit = limits != nullptr ? limits->Find(name) : nullptr;
    const bool stated = limit != nullptr && limit->is_number();
    options.limit = stated ? limit->number() : 0.1;
    options.constant_limit = options.limit;
    const score::Series measured{*series.time, *series.values};
    const score::Series simulated = SeriesOf(samples, *prepared.rig, name, &options.nominal);
    const score::NrmseResult result = score::Nrmse(measured, simulated, options);
    score::Check check =
        score::NrmseCheck(result, options, "record " + name,
                          stated ? "stated in [record] of the scenario"
                                 : "no limit stated in [record] nrmse: a tenth of the signal's own spread");
    check.kind = "record";
    if (result.nrmse) figures[name + ".nrmse"] = {*result.nrmse, "1"};
    if (check.verdict != score::Verdict::kPass && score::FaultOf(measured, "record").empty()) {
      check.explanation = Why(measured, simulated, options.limit * score::StandardDeviation(*series.values),
                              prepared.rig->outputs[FindOutput(*prepared.rig, name)].unit);
    }
    checks.push_back(std::move(check));
  }
  if (limits == nullptr || data.outputs.empty()) return checks;
  for (const std::string& name : KeysOf(*limits)) {
    if (data.outputs.contains(name)) continue;
    score::Check& missing = checks.emplace_back();
    missing.name = "record " + name;
    missing.kind = "record";
    missing.explanation = "[record] limits this output, but the record does not have it";
  }
  return checks;
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

trace::Trace MakeTrace(const Prepared& prepared, const Samples& samples) {
  trace::Trace trace;
  trace.time = samples.time;
  const Rig& rig = *prepared.rig;
  for (std::size_t i = 0; i < rig.inputs.size(); ++i) {
    const InputLine& line = rig.inputs[i];
    trace.signals.push_back(
        {line.name, line.unit, line.description, line.nominal, trace::Interpolation::kHold, samples.inputs[i]});
  }
  for (std::size_t i = 0; i < rig.outputs.size(); ++i) {
    const OutputLine& line = rig.outputs[i];
    trace.signals.push_back(
        {line.name, line.unit, line.description, line.nominal, trace::Interpolation::kLinear, samples.outputs[i]});
  }
  AddHull(prepared, trace);
  trace.scenario = ToToml(prepared.plan.root);
  trace.provenance = BuildProvenance();
  trace.provenance.Set("solver", rig.run.solver);
  trace.provenance.Set("solver_summary", samples.solver_summary);
  trace.provenance.SetCounter("seed", rig.run.seed);
  for (const auto& [name, count] : samples.counters) trace.provenance.SetCounter("solver_" + name, count);
  return trace;
}

Result<Course> Play(const Prepared& prepared, const Progress& progress) {
  const Rig& rig = *prepared.rig;
  const Result<std::unique_ptr<Solver>> solver = MakeSolver(rig.run.solver, rig);
  if (!solver.ok()) return solver.failure();
  Result<Samples> samples = Simulate(rig, **solver, progress);
  if (!samples.ok()) return samples.failure();
  trace::Trace trace = MakeTrace(prepared, *samples);
  if (Status failed = AddVariants(prepared, trace)) return *failed;
  return Course{std::move(*samples), std::move(trace)};
}

ScenarioResult RunScenario(const Prepared& prepared, const RunOptions& options) {
  ScenarioResult result;
  result.id = prepared.plan.id;
  result.title = prepared.title;
  result.notes = prepared.notes;
  const auto broken = [&result](const Failure& failure) {
    result.verdict = score::Verdict::kBroken;
    result.broken = failure.ToString();
    result.exit_code = failure.exit_code;
    return result;
  };
  const Result<Course> course = Play(prepared, options.progress);
  if (!course.ok()) return broken(course.failure());
  if (!options.out.empty()) {
    const std::string file = (std::filesystem::path(options.out) / (result.id + ".h5")).string();
    if (Status failed = trace::WriteTrace(file, course->trace)) return broken(*failed);
    result.trace_file = file;
  }

  CheckContext context(prepared.plan, *prepared.rig, course->samples, prepared.rig->run.solver);
  context.trace = &course->trace;
  context.registry = prepared.registry;
  context.records = prepared.records.get();
  for (const auto& check : prepared.checks) {
    std::vector<score::Check> made = check->Run(context);
    if (made.empty()) {  // a check that says nothing is none: a fresh Check fails
      made.emplace_back();
      made.back().name = "a check without a result";
    }
    result.checks.insert(result.checks.end(), made.begin(), made.end());
  }
  result.figures = std::move(context.figures);
  if (options.data != nullptr) {
    result.notes.insert(result.notes.end(), options.data->notes.begin(), options.data->notes.end());
    result.checks = CompareWithRecord(prepared, course->samples, *options.data, result.figures);
    if (result.checks.empty()) {
      result.notes.push_back("the record has no output of the scenario: nothing was compared");
    }
  } else if (result.checks.empty()) {
    result.notes.push_back("the scenario states no checks: nothing was compared");
  }
  const bool inputs_alone = options.data != nullptr && result.checks.empty();
  result.verdict = inputs_alone ? score::Verdict::kInconclusive : score::Combine(result.checks);
  if (options.seen) options.seen(*course, context, result);
  return result;
}

}  // namespace dynoproof
