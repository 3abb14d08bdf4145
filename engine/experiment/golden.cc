#include "experiment/golden.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>

#include "base/atomic_file.h"
#include "base/text.h"
#include "base/within.h"
#include "experiment/measured_record.h"
#include "experiment/thin.h"
#include "scenario/changes.h"
#include "scenario/find.h"
#include "scenario/load.h"
#include "trace/trace_io.h"

namespace dynoproof {
namespace {

namespace fs = std::filesystem;

/// The run's length and its solver's counters, which the thinned golden trace does not show.
std::vector<score::Check> CompareLengthAndCost(const GoldenTolerances::OfRun& golden, const trace::Trace& run) {
  const bool same = run.time.size() == static_cast<std::size_t>(golden.samples) && !run.time.empty() &&
                    std::abs(run.time.back() - golden.end_s) <= 1e-9;
  if (!same) {
    return {NotCompared("golden length", "tube",
                        fmt::format("{} samples to {:.9g} s, golden {} to {:.9g} s", run.time.size(),
                                    run.time.empty() ? 0.0 : run.time.back(), golden.samples, golden.end_s))};
  }
  std::vector<score::Check> checks = {
      score::AtMost("golden length", "tube", 0.0, 0.0, "s", "samples and last time are exact", "")};
  // Another solver has other counters: they say nothing then.
  if (run.provenance.Text("solver") != golden.solver) return checks;
  double worst = 0.0;
  std::string which;
  for (const auto& [name, want] : golden.counters) {
    const std::optional<std::int64_t> have = run.provenance.Counter("solver_" + name);
    const double off = have ? std::abs(static_cast<double>(*have) - want) / std::max(want, 1.0) : INFINITY;
    if (off <= worst) continue;
    worst = off;
    which = fmt::format("{}: {} instead of {:.0f}", name, have ? fmt::format("{}", *have) : "none", want);
  }
  checks.push_back(score::AtMost("golden solver counters", "counters", worst, 0.1, "1",
                                 "a tenth: rounding moves an adaptive step now and then, a changed method moves more",
                                 which));
  return checks;
}

/// Every check that was stated when the run was blessed still is: one that was deleted would pass in silence.
std::vector<score::Check> CompareChecks(const std::vector<std::string>& blessed, const Plan& plan) {
  if (blessed.empty()) return {};
  const std::vector<std::string> stated = StatedChecks(plan);
  std::vector<std::string> gone;
  std::set_difference(blessed.begin(), blessed.end(), stated.begin(), stated.end(), std::back_inserter(gone));
  return {score::AtMost("golden checks", "tube", static_cast<double>(gone.size()), 0.0, "1",
                        fmt::format("the {} checks that the scenario stated when it was blessed", blessed.size()),
                        gone.empty() ? ""
                                     : fmt::format("no longer stated: {}; state them again, or bless the scenario "
                                                   "without them",
                                                   fmt::join(gone, ", ")))};
}

/// Largest distance of two signals over the nominal; NaN where they have other time stamps or are not finite.
double LargestDistance(const trace::Trace& a, const trace::Signal& of_a, const trace::Trace& b) {
  const trace::Signal* of_b = b.Find(of_a.name);
  const auto differs = [&] {
    return of_b == nullptr || of_b->values.size() != of_a.values.size() ||
           !std::ranges::equal(a.TimeOf(of_a), b.TimeOf(*of_b));
  };
  if (differs()) return std::numeric_limits<double>::quiet_NaN();
  double most = 0.0;
  for (std::size_t i = 0; i < of_a.values.size(); ++i) {
    const double distance = std::abs(of_a.values[i] - of_b->values[i]) / of_a.nominal;
    if (!(distance <= most)) most = distance;  // a NaN stays
    if (std::isnan(most)) break;
  }
  return most;
}

/// Rounded up to two digits.
double RoundedUp(double value) {
  const double unit = std::pow(10.0, std::floor(std::log10(value)) - 1.0);
  return std::stod(fmt::format("{:.1e}", std::ceil(value / unit * (1.0 - 1e-12)) * unit));
}

/// How far a run of the other solver may be: the adaptive steps of another machine are not those of this one.
void AllowOtherSolver(double distance, const std::string& own, const std::string& other,
                      GoldenTolerances::OfSignal& tolerance) {
  constexpr double kRoom = 3.0;
  tolerance.other_solver_width = 0.0;
  if (!std::isfinite(distance)) {
    tolerance.other_solver_origin = fmt::format("`{}` and `{}` could not be compared when blessed", other, own);
    return;
  }
  const double wide = kRoom * distance;
  const bool wider = !Within(wide, tolerance.relative_width);
  tolerance.other_solver_width = wider ? RoundedUp(wide) : tolerance.relative_width;
  tolerance.other_solver_origin =
      wider
          ? fmt::format("`{}` was {:.2g} of the nominal from `{}` when blessed, times {:g} for other steps elsewhere",
                        other, distance, own, kRoom)
          : fmt::format("`{}` was {:.2g} of the nominal from `{}` when blessed: no more room than for the same solver",
                        other, distance, own);
}

/// Where a trace is written before its tolerance file names it.
std::string NextTrace(const GoldenPlace& place) {
  const fs::path trace = place.trace;
  return (trace.parent_path() / ("." + trace.filename().string() + ".next")).string();
}

/// The trace that the tolerance file was written for. `bless` writes the trace under another name, then the tolerance file, whose
/// rename decides, and renames the trace last: where it was killed between the two, the other name holds it.
std::string TraceFor(const GoldenPlace& place, const GoldenTolerances& tolerances) {
  std::error_code error;
  const std::string next = NextTrace(place);
  const bool pending = !tolerances.trace_sha256.empty() && fs::exists(next, error) &&
                       tolerances.trace_sha256 != HashOf(place.trace) && tolerances.trace_sha256 == HashOf(next);
  return pending ? next : place.trace;
}

/// The same, where the tolerance file can be read.
std::string TraceOf(const GoldenPlace& place) {
  const Result<GoldenTolerances> tolerances = ReadTolerances(place.tolerances);
  return tolerances.ok() ? TraceFor(place, *tolerances) : place.trace;
}

}  // namespace

SignalTolerances GoldenTolerances::For(const std::string& solver) const {
  SignalTolerances widths = signals;
  if (run.solver.empty() || solver == run.solver) return widths;
  for (auto& [name, of] : widths) {
    of.relative_width = of.other_solver_width;
    of.origin = of.other_solver_origin;
  }
  return widths;
}

std::vector<std::string> StatedChecks(const Plan& plan) {
  std::vector<std::string> stated;
  const Value* checks = plan.root.Find("check");
  for (const Value& check : checks != nullptr && checks->is_array() ? checks->array() : Value::Array{}) {
    std::string text;
    for (const char* key : {"kind", "signal", "shaft", "speed"}) {
      const Value* word = check.Find(key);
      if (word != nullptr && word->is_string() && !word->string().empty())
        text += (text.empty() ? "" : " ") + word->string();
    }
    stated.push_back(text);
  }
  std::sort(stated.begin(), stated.end());
  return stated;
}

bool ComparesWithGolden(const std::vector<std::string>& stated) {
  return std::find(stated.begin(), stated.end(), GoldenCheck::kName) != stated.end();
}

bool IsOfGolden(const score::Check& check) { return check.stated == GoldenCheck::kName; }

std::optional<score::Check> GoldenNotStated(const GoldenPlace& place, const Plan& plan) {
  if (std::error_code error; ComparesWithGolden(StatedChecks(plan)) || !fs::exists(place.trace, error))
    return std::nullopt;
  score::Check check = NotCompared(
      "golden", "tube",
      fmt::format("there is golden data, {}, and no [[check]] with kind = \"golden\" compares with it; state "
                  "the check, or delete the data",
                  place.trace));
  check.stated = GoldenCheck::kName;
  return check;
}

std::string GoldenFolder() {
  if (const char* folder = std::getenv("DYNOPROOF_GOLDEN"); folder != nullptr && *folder != '\0') return folder;
  return (fs::path(ScenarioFolder()).parent_path() / "golden").lexically_normal().string();
}

Result<GoldenTolerances> ReadTolerances(const std::string& file) {
  Diagnostics diagnostics;
  const std::optional<Plan> plan = LoadPlan(file, {}, diagnostics);
  if (!plan) return Failure{.message = diagnostics.Format(), .signal = file, .exit_code = 2};
  GoldenTolerances tolerances;
  tolerances.reason = plan->root.TextOr("reason");
  tolerances.trace_sha256 = plan->root.TextOr("trace_sha256");
  const Value* checks = plan->root.Find("checks");
  for (const Value& check : checks != nullptr && checks->is_array() ? checks->array() : Value::Array{}) {
    if (check.is_string()) tolerances.checks.push_back(check.string());
  }
  std::sort(tolerances.checks.begin(), tolerances.checks.end());
  if (const Value* run = plan->root.Find("run"); run != nullptr) {
    if (!ReadParams(*run, tolerances.run, diagnostics, "run"))
      return Failure{.message = diagnostics.Format(), .signal = file, .exit_code = 2};
  }
  const Value* signals = plan->root.Find("signal");
  for (const Value::Entry& entry : signals != nullptr && signals->is_table() ? signals->table() : Value::Table{}) {
    GoldenTolerances::OfSignal tolerance;
    if (!ReadParams(entry.value, tolerance, diagnostics, "signal." + entry.key)) {
      return Failure{.message = diagnostics.Format(), .signal = file, .exit_code = 2};
    }
    tolerance.where = entry.where;
    tolerances.signals[entry.key] = tolerance;
  }
  return tolerances;
}

bool IsGoldenPair(const GoldenTolerances& tolerances, const std::string& trace_file) {
  return !tolerances.trace_sha256.empty() && tolerances.trace_sha256 == HashOf(trace_file);
}

std::vector<score::Check> CompareWithGolden(const GoldenPlace& place, const Plan& plan, const trace::Trace& run) {
  const Result<GoldenTolerances> tolerances = ReadTolerances(place.tolerances);
  const std::string trace_file = tolerances.ok() ? TraceFor(place, *tolerances) : place.trace;
  const Result<trace::Trace> golden = trace::ReadTrace(trace_file);
  if (!golden.ok()) {
    return {NotCompared("golden", "tube",
                        fmt::format("{}; if this run is right: {}", golden.failure().ToString(), place.bless))};
  }
  if (!tolerances.ok()) return {NotCompared("golden", "tube", tolerances.failure().ToString())};
  const std::string solver = run.provenance.Text("solver").value_or("");
  const SignalTolerances widths = tolerances->For(solver);
  std::vector<score::Check> checks = CompareLengthAndCost(tolerances->run, run);
  if (!tolerances->trace_sha256.empty() && tolerances->trace_sha256 != HashOf(trace_file)) {
    checks.push_back(NotCompared(
        "golden trace", "tube",
        fmt::format("{} is not the trace that its tolerance file was written for (SHA-256 differs): take both "
                    "from one commit, or bless the scenario anew: {}",
                    place.trace, place.bless)));
  }
  for (score::Check& check : CompareChecks(tolerances->checks, plan)) checks.push_back(std::move(check));
  for (const trace::Signal& signal : golden->signals) {
    const auto of = widths.find(signal.name);
    if (of == widths.end() || of->second.relative_width > 0.0) continue;
    checks.push_back(
        NotCompared("golden " + signal.name, "tube",
                    fmt::format("the golden run is of `{}`, and how far `{}` may be from it is not known{}{}; "
                                "bless the scenario anew: {}",
                                tolerances->run.solver, solver, of->second.origin.empty() ? "" : ": ",
                                of->second.origin, place.bless)));
    return checks;
  }
  Diagnostics of_nothing;
  CheckTolerances(widths, *golden, run, of_nothing);
  if (of_nothing.has_errors()) checks.push_back(NotCompared("golden tolerances", "tube", of_nothing.Format()));
  for (score::Check& check : CompareTraces(*golden, run, widths, "golden", ReferenceIs::kThinned))
    checks.push_back(std::move(check));
  return checks;
}

Result<std::optional<Value>> BlessedScenario(const GoldenPlace& place) {
  std::error_code error;
  if (!fs::exists(TraceOf(place), error)) return std::optional<Value>();
  const Result<trace::Trace> golden = trace::ReadTrace(TraceOf(place));
  if (!golden.ok()) return golden.failure();
  return FromToml(golden->scenario);
}

std::vector<std::string> ChangedSinceBlessed(const GoldenPlace& place, const Plan& plan) {
  const Result<std::optional<Value>> blessed = BlessedScenario(place);
  if (!blessed.ok() || !*blessed) return {};
  Value was = **blessed, is = plan.root;
  for (const char* key : {"title", "source", "check", "budget", "format"}) was.Erase(key), is.Erase(key);
  return ChangesBetween(was, is);
}

Result<std::string> KeepGolden(const GoldenPlace& place, bool fell_short, const std::string& trace_file,
                               const std::string& kept) {
  std::error_code error;
  const std::string trace = TraceOf(place);
  const bool itself = fs::equivalent(kept, trace, error);  // the traces go to the golden file's own folder
  if (!itself) fs::remove(kept, error);
  if (!fell_short || !fs::exists(trace, error)) return std::string();
  if (!itself) {
    const std::optional<std::string> bytes = ReadTextFile(trace);
    if (!bytes) return Failure{"cannot be read", trace};
    if (Status failed = WriteFileAtomically(kept, *bytes)) return *failed;
  }
  return fmt::format("this run: {0}, the golden one: {1}; dynoproof compare {1} {0} --tolerance {2}", trace_file, kept,
                     place.tolerances);
}

Status WriteGolden(const GoldenPlace& place, const GoldenRun& golden) {
  const trace::Trace& run = golden.own;
  const Result<GoldenTolerances> old = ReadTolerances(place.tolerances);
  // Somebody's tolerances and reasons stand in a faulty file: they are not to be replaced by defaults.
  if (std::error_code error; !old.ok() && fs::exists(place.tolerances, error)) return old.failure();
  const std::string next = NextTrace(place);
  if (Status failed = trace::WriteTrace(next, Thin(run), {.deflate_level = 9})) return failed;
  Value root;
  root["reason"] = Value(golden.reason);
  root["trace_sha256"] = Value(HashOf(next));
  Value::Array checks;
  for (const std::string& check : golden.checks) checks.push_back(Value(check));
  root["checks"] = Value(checks);
  for (const char* key : {"version", "commit", "compiler", "cpu"}) {
    root["provenance"][key] = Value(run.provenance.Text(key).value_or("unknown"));
  }
  root["run"] = Value{{"samples", static_cast<std::int64_t>(run.time.size())},
                      {"end_s", run.time.empty() ? 0.0 : run.time.back()},
                      {"solver", run.provenance.Text("solver").value_or("unknown")}};
  for (const auto& [name, count] : run.provenance.counters) {
    if (name.starts_with("solver_")) root["run"]["counters"][name.substr(7)] = Value(count);
  }
  for (const trace::Signal& signal : run.signals) {
    const bool kept = old.ok() && old->signals.contains(signal.name);
    GoldenTolerances::OfSignal of = kept ? old->signals.at(signal.name) : GoldenTolerances::OfSignal{};
    AllowOtherSolver(LargestDistance(run, signal, golden.other), run.provenance.Text("solver").value_or(""),
                     golden.other.provenance.Text("solver").value_or(""), of);
    Value& table = root["signal"][signal.name];
    table["relative_width"] = Value(of.relative_width);
    if (of.time_half_width_s > 0.0) table["time_half_width_s"] = Value(of.time_half_width_s);
    table["origin"] = Value(of.origin);
    table["other_solver_width"] = Value(of.other_solver_width);
    table["other_solver_origin"] = Value(of.other_solver_origin);
  }
  if (Status failed = WriteFileAtomically(place.tolerances, ToToml(root))) return failed;
  std::error_code error;
  fs::rename(next, place.trace, error);
  if (error)
    return Failure{fmt::format("cannot rename {} to it: {}; until then the former is taken", next, error.message()),
                   place.trace};
  return {};
}

std::vector<score::Check> GoldenCheck::Run(CheckContext& context) const {
  return CompareWithGolden(*context.golden, context.plan(), *context.trace);
}

}  // namespace dynoproof
