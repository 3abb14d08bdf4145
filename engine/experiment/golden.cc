#include "experiment/golden.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <limits>

#include "base/atomic_file.h"
#include "base/text.h"
#include "experiment/measured_record.h"
#include "experiment/why.h"
#include "scenario/find.h"
#include "scenario/load.h"
#include "score/tube.h"
#include "trace/trace_io.h"

namespace dynoproof {
namespace {

namespace fs = std::filesystem;

std::size_t NextPrime(std::size_t n) {
  for (;; ++n) {
    bool prime = n > 1;
    for (std::size_t d = 2; d * d <= n && prime; ++d) prime = n % d != 0;
    if (prime) return n;
  }
}

std::vector<double> EveryNth(const std::vector<double>& values, std::size_t n) {
  std::vector<double> thin;
  for (std::size_t i = 0; i < values.size(); i += n) thin.push_back(values[i]);
  return thin;
}

score::Check Failed(const std::string& name, const std::string& kind, std::string why) {
  score::Check check;
  check.name = name;
  check.kind = kind;
  check.value = std::numeric_limits<double>::quiet_NaN();
  check.limit = 1.0;
  check.unit = "1";
  check.origin = "a comparison that does not happen proves nothing";
  check.explanation = std::move(why);
  return check;
}

score::Interpolation ToScore(trace::Interpolation interpolation) {
  return interpolation == trace::Interpolation::kHold ? score::Interpolation::kHold : score::Interpolation::kLinear;
}

/// The samples of `test` at exactly the times of `reference`; empty when it lacks one (within a millionth of a step).
std::vector<double> SamplesAt(std::span<const double> times, std::span<const double> test_time,
                              std::span<const double> values) {
  std::vector<double> samples;
  const double slack = 1e-6 * score::MedianStep(test_time);
  for (const double time : times) {
    const auto it = std::lower_bound(test_time.begin(), test_time.end(), time - slack);
    if (it == test_time.end() || *it > time + slack) return {};
    samples.push_back(values[it - test_time.begin()]);
  }
  return samples;
}

/// The run's length and its solver's counters, which the thinned golden trace does not show.
std::vector<score::Check> CompareLengthAndCost(const GoldenTolerances::OfRun& golden, const trace::Trace& run) {
  const bool same = run.time.size() == static_cast<std::size_t>(golden.samples) && !run.time.empty() &&
                    std::abs(run.time.back() - golden.end_s) <= 1e-9;
  if (!same) {
    return {Failed("golden length", "tube",
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
  tolerance.other_solver_width = wide > tolerance.relative_width ? RoundedUp(wide) : tolerance.relative_width;
  tolerance.other_solver_origin =
      wide > tolerance.relative_width
          ? fmt::format("`{}` was {:.2g} of the nominal from `{}` when blessed, times {:g} for other steps elsewhere",
                        other, distance, own, kRoom)
          : fmt::format("`{}` was {:.2g} of the nominal from `{}` when blessed: no more room than for the same solver",
                        other, distance, own);
}

}  // namespace

std::map<std::string, GoldenTolerances::OfSignal> GoldenTolerances::For(const std::string& solver) const {
  std::map<std::string, OfSignal> widths = signals;
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
  score::Check check =
      Failed("golden", "tube",
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
    tolerances.signals[entry.key] = tolerance;
  }
  return tolerances;
}

trace::Trace Thin(const trace::Trace& trace, std::size_t most_bytes) {
  std::size_t numbers = trace.time.size();
  for (const std::vector<double>& time : trace.other_times) numbers += time.size();
  for (const trace::Signal& signal : trace.signals) numbers += signal.values.size();
  const std::size_t least = (8 * numbers + most_bytes - 1) / most_bytes;
  // A prime step never falls into step with a period of the signal or of a controller.
  const std::size_t step = least <= 1 ? 1 : NextPrime(least);
  trace::Trace thin = trace;
  const auto thin_out = [step](std::vector<double>& values) {
    values = EveryNth(values, values.size() < 4000 ? 1 : step);
  };
  thin_out(thin.time);
  for (std::vector<double>& time : thin.other_times) thin_out(time);
  for (trace::Signal& signal : thin.signals) thin_out(signal.values);
  return thin;
}

std::vector<score::Check> CompareTraces(const trace::Trace& reference, const trace::Trace& test,
                                        const std::map<std::string, GoldenTolerances::OfSignal>& tolerances,
                                        const std::string& kind) {
  std::vector<score::Check> checks;
  for (const trace::Signal& want : reference.signals) {
    const std::string name = kind + " " + want.name;
    const trace::Signal* have = test.Find(want.name);
    if (have == nullptr) {
      checks.push_back(Failed(name, kind, fmt::format("the run has no signal \"{}\"", want.name)));
      continue;
    }
    if (have->unit != want.unit) {
      checks.push_back(Failed(name, kind, fmt::format("unit \"{}\" instead of \"{}\"", have->unit, want.unit)));
      continue;
    }
    const std::span<const double> times = reference.TimeOf(want), test_times = test.TimeOf(*have);
    const std::vector<double> samples = SamplesAt(times, test_times, have->values);
    if (samples.empty()) {
      checks.push_back(Failed(
          name, kind,
          fmt::format("other time stamps: {} samples from {} to {} s", test_times.size(),
                      test_times.empty() ? 0.0 : test_times.front(), test_times.empty() ? 0.0 : test_times.back())));
      continue;
    }
    if (test_times.back() > times.back() + (times.size() > 1 ? 1.5 * (times.back() - times[times.size() - 2]) : 0.0)) {
      checks.push_back(
          Failed(name, kind,
                 fmt::format("the run goes on to {} s, the reference ends at {} s", test_times.back(), times.back())));
      continue;
    }
    const auto found = tolerances.find(want.name);
    const GoldenTolerances::OfSignal tolerance =
        found == tolerances.end() ? GoldenTolerances::OfSignal{} : found->second;
    const score::Series golden{times, want.values, ToScore(want.interpolation)},
        run{times, samples, ToScore(want.interpolation)};
    score::TubeOptions options;
    options.relative_width = tolerance.relative_width;
    options.nominal = want.nominal;
    options.time_half_width_s = tolerance.time_half_width_s;
    const score::TubeResult result = score::CompareTube(golden, run, options);
    score::Check check = score::TubeCheck(result, name, tolerance.origin);
    check.kind = kind == "golden" ? "tube" : kind;
    check.evidence = score::TubeEvidence({want.name, want.unit, kind, "run"}, golden, result, options);
    if (check.verdict != score::Verdict::kPass && score::FaultOf(run, "run").empty()) {
      // All samples of the run: they show a delay that is shorter than the thinned trace's step.
      const score::Series all{test_times, have->values, ToScore(have->interpolation)};
      const bool sound = score::FaultOf(all, "run").empty();
      check.explanation = Why(golden, sound ? all : run, tolerance.relative_width * want.nominal, want.unit);
    }
    checks.push_back(std::move(check));
  }
  for (const trace::Signal& have : test.signals) {
    if (reference.Find(have.name) != nullptr) continue;
    checks.push_back(
        Failed(kind + " " + have.name, kind, fmt::format("the reference has no signal \"{}\"", have.name)));
  }
  return checks;
}

std::vector<score::Check> CompareWithGolden(const GoldenPlace& place, const Plan& plan, const trace::Trace& run) {
  const Result<trace::Trace> golden = trace::ReadTrace(place.trace);
  if (!golden.ok()) {
    return {Failed("golden", "tube",
                   fmt::format("{}; if this run is right: {}", golden.failure().ToString(), place.bless))};
  }
  const Result<GoldenTolerances> tolerances = ReadTolerances(place.tolerances);
  if (!tolerances.ok()) return {Failed("golden", "tube", tolerances.failure().ToString())};
  const std::string solver = run.provenance.Text("solver").value_or("");
  const std::map<std::string, GoldenTolerances::OfSignal> widths = tolerances->For(solver);
  std::vector<score::Check> checks = CompareLengthAndCost(tolerances->run, run);
  if (!tolerances->trace_sha256.empty() && tolerances->trace_sha256 != HashOf(place.trace)) {
    checks.push_back(
        Failed("golden trace", "tube",
               fmt::format("{} is not the trace that its tolerance file was written for (SHA-256 differs): take both "
                           "from one commit, or bless the scenario anew: {}",
                           place.trace, place.bless)));
  }
  for (score::Check& check : CompareChecks(tolerances->checks, plan)) checks.push_back(std::move(check));
  for (const trace::Signal& signal : golden->signals) {
    const auto of = widths.find(signal.name);
    if (of == widths.end() || of->second.relative_width > 0.0) continue;
    checks.push_back(Failed("golden " + signal.name, "tube",
                            fmt::format("the golden run is of `{}`, and how far `{}` may be from it is not known{}{}; "
                                        "bless the scenario anew: {}",
                                        tolerances->run.solver, solver, of->second.origin.empty() ? "" : ": ",
                                        of->second.origin, place.bless)));
    return checks;
  }
  for (score::Check& check : CompareTraces(*golden, run, widths, "golden")) checks.push_back(std::move(check));
  return checks;
}

Result<std::string> KeepGolden(const GoldenPlace& place, bool fell_short, const std::string& trace_file,
                               const std::string& kept) {
  std::error_code error;
  const bool itself = fs::equivalent(kept, place.trace, error);  // the traces go to the golden file's own folder
  if (!itself) fs::remove(kept, error);
  if (!fell_short || !fs::exists(place.trace, error)) return std::string();
  if (!itself) {
    const std::optional<std::string> bytes = ReadTextFile(place.trace);
    if (!bytes) return Failure{"cannot be read", place.trace};
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
  trace::Trace thin = Thin(run);
  if (Status failed = trace::WriteTrace(place.trace, thin, {.deflate_level = 9})) return failed;
  Value root;
  root["reason"] = Value(golden.reason);
  root["trace_sha256"] = Value(HashOf(place.trace));
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
  for (const trace::Signal& signal : thin.signals) {
    const bool kept = old.ok() && old->signals.contains(signal.name);
    GoldenTolerances::OfSignal of = kept ? old->signals.at(signal.name) : GoldenTolerances::OfSignal{};
    AllowOtherSolver(LargestDistance(run, *run.Find(signal.name), golden.other),
                     run.provenance.Text("solver").value_or(""), golden.other.provenance.Text("solver").value_or(""),
                     of);
    Value& table = root["signal"][signal.name];
    table["relative_width"] = Value(of.relative_width);
    if (of.time_half_width_s > 0.0) table["time_half_width_s"] = Value(of.time_half_width_s);
    table["origin"] = Value(of.origin);
    table["other_solver_width"] = Value(of.other_solver_width);
    table["other_solver_origin"] = Value(of.other_solver_origin);
  }
  return WriteFileAtomically(place.tolerances, ToToml(root));
}

std::vector<score::Check> GoldenCheck::Run(CheckContext& context) const {
  return CompareWithGolden(*context.golden, context.plan(), *context.trace);
}

}  // namespace dynoproof
