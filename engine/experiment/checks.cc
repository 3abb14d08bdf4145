#include "experiment/checks.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "experiment/check_resonances.h"
#include "experiment/check_time_course.h"
#include "experiment/check_windows.h"
#include "experiment/golden.h"
#include "experiment/kept_reference.h"
#include "experiment/why.h"
#include "oracles/oracle.h"
#include "score/nrmse.h"
#include "sim/solver.h"

namespace dynoproof {

int FindOutput(const Rig& rig, std::string_view name) {
  for (std::size_t i = 0; i < rig.outputs.size(); ++i) {
    if (rig.outputs[i].name == name) return static_cast<int>(i);
  }
  return -1;
}

int FindInput(const Rig& rig, std::string_view name) {
  for (std::size_t i = 0; i < rig.inputs.size(); ++i) {
    if (rig.inputs[i].name == name) return static_cast<int>(i);
  }
  return -1;
}

score::Series SeriesOf(const Samples& samples, const Rig& rig, const std::string& signal, double* nominal) {
  if (const int output = FindOutput(rig, signal); output >= 0) {
    if (nominal != nullptr) *nominal = rig.outputs[output].nominal;
    return {samples.time, samples.outputs[output], score::Interpolation::kLinear};
  }
  if (const int input = FindInput(rig, signal); input >= 0) {
    if (nominal != nullptr) *nominal = rig.inputs[input].nominal;
    return {samples.time, samples.inputs[input], score::Interpolation::kHold};
  }
  return {};
}

score::Check FailedCheck(const char* kind, std::string name, double limit, std::string unit, const std::string& origin,
                         std::string why) {
  score::Check check;
  check.name = std::move(name);
  check.kind = kind;
  check.value = std::numeric_limits<double>::quiet_NaN();
  check.limit = limit;
  check.unit = std::move(unit);
  check.origin = origin;
  check.explanation = std::move(why);
  return check;
}

double RelativeDistance(const Samples& reference, const Samples& test, int output, double from_s, double to_s) {
  double error = 0.0, mean = 0.0, square = 0.0;
  int count = 0;
  const std::vector<double>&a = reference.outputs[output], &b = test.outputs[output];
  for (std::size_t k = 0; k < reference.time.size(); ++k) {
    if (reference.time[k] < from_s || reference.time[k] > to_s) continue;
    ++count;
    error += (a[k] - b[k]) * (a[k] - b[k]);
    mean += a[k];
    square += a[k] * a[k];
  }
  if (count < 2) return std::numeric_limits<double>::quiet_NaN();
  mean /= count;
  const double spread = square / count - mean * mean;
  return spread > 0.0 ? std::sqrt(error / count / spread) : std::numeric_limits<double>::quiet_NaN();
}

CheckContext::CheckContext(const Plan& plan, const Rig& rig, const Samples& samples, const std::string& solver)
    : plan_(plan), rig_(rig), samples_(samples), solver_(solver) {}

CheckContext::~CheckContext() = default;

std::optional<RunSignal> CheckContext::Find(const std::string& name) const {
  const int output = FindOutput(rig_, name), input = FindInput(rig_, name);
  if (output < 0 && input < 0) return std::nullopt;
  RunSignal signal{.series = {}, .unit = output >= 0 ? rig_.outputs[output].unit : rig_.inputs[input].unit};
  signal.series = SeriesOf(samples_, rig_, name, &signal.nominal);
  return signal;
}

const Result<Samples>& CheckContext::Other() {
  if (other_ != nullptr) return *other_;
  const std::string name = solver_ == "reference" ? "realtime" : "reference";
  const bool keeps = kept != nullptr && name == "reference";  // `realtime` takes no time worth keeping
  if (keeps) {
    if (std::optional<Samples> samples = kept->Find()) {
      kept_note = "`reference` was not computed again: its samples are those of " + kept->file();
      other_ = std::make_unique<Result<Samples>>(*std::move(samples));
      return *other_;
    }
  }
  Result<std::unique_ptr<Solver>> solver = MakeSolver(name, rig_);
  other_ =
      std::make_unique<Result<Samples>>(solver.ok() ? Simulate(rig_, **solver) : Result<Samples>(solver.failure()));
  if (keeps && other_->ok()) {
    if (const Status failed = kept->Keep(**other_))
      kept_note = "the samples of `reference` were not kept: " + failed->ToString();
  }
  return *other_;
}

Result<std::vector<double>> CheckContext::Oracle(const std::string& oracle, const std::string& output) {
  auto& answers = answers_[oracle];
  if (!answers.contains(output)) {
    oracles::Question question{plan_.root, samples_.time, {}, {}};
    for (std::size_t i = 0; i < rig_.inputs.size(); ++i) question.inputs[rig_.inputs[i].name] = samples_.inputs[i];
    // One question for all outputs: the costly part of an oracle is the same for each.
    for (const OutputLine& line : rig_.outputs) question.outputs.push_back(line.name);
    Result<oracles::Answer> answer = oracles::All().at(oracle)(question);
    if (!answer.ok()) {  // an output that the oracle does not know must not take the others with it
      question.outputs = {output};
      answer = oracles::All().at(oracle)(question);
    }
    if (!answer.ok()) return answer.failure();
    for (auto& [name, values] : *answer) answers[name] = std::move(values);
  }
  const auto answer = answers.find(output);
  if (answer != answers.end()) return answer->second;
  return Failure{.message = "it has no answer for this output", .signal = output, .exit_code = 3};
}

namespace {

/// NRMSE of two courses of a signal, with the reason when it is too large. `who`: names of reference and test.
score::Check CompareNrmse(const CheckContext& context, const std::string& signal, const score::Series& reference,
                          const score::Series& test, const std::pair<std::string, std::string>& who, double limit,
                          std::string name, std::string kind, const std::string& origin) {
  score::NrmseOptions options;
  options.limit = limit;
  options.constant_limit = limit;
  SeriesOf(context.samples(), context.rig(), signal, &options.nominal);
  const score::NrmseResult result = score::Nrmse(reference, test, options);
  score::Check check = score::NrmseCheck(result, options, std::move(name), origin);
  check.kind = std::move(kind);
  if (!score::FaultOf(reference, "reference").empty()) return check;
  const int output = FindOutput(context.rig(), signal);
  const std::string unit = output >= 0 ? context.rig().outputs[output].unit : "";
  const double allowed = limit * score::StandardDeviation(reference.values);
  if (check.verdict != score::Verdict::kPass) Why(reference, test, allowed, unit).To(check);
  check.evidence =
      score::BandEvidence({signal, unit, who.first, who.second}, score::Evidence::Rule::kRms, reference, test, allowed);
  return check;
}

score::Check NotMade(std::string name, std::string kind, double limit, const std::string& origin,
                     const Failure& failure) {
  score::Check check;
  check.name = std::move(name);
  check.kind = std::move(kind);
  check.verdict = failure.exit_code == 3 ? score::Verdict::kBroken : score::Verdict::kFail;
  check.value = std::numeric_limits<double>::quiet_NaN();
  check.limit = limit;
  check.origin = origin;
  check.explanation = failure.ToString();
  return check;
}

class SolversCheck : public CheckPlan {
 public:
  struct Params {
    std::string signal, origin;
    double nrmse = 0.0;
    void Visit(auto& v) {
      v.Required("signal", signal, Any(), "output that is compared");
      v.Required("nrmse", nrmse, Positive("1"), "largest distance of the two solvers");
      v.Required("origin", origin, Any(), "why this limit");
    }
  };
  static constexpr const char* kName = "solvers";
  static constexpr bool kFollowsPlan = true;
  static constexpr const char* kRelativeLimits[] = {"nrmse"};
  static constexpr bool kComparesSolvers = true;
  static constexpr const char* kSummary = "`realtime` against `reference`";
  explicit SolversCheck(Params params) : p_(std::move(params)) {}
  std::vector<std::string> Signals() const override { return {p_.signal}; }

  std::vector<score::Check> Run(CheckContext& context) const override {
    const std::string name = "solvers " + p_.signal;
    const Result<Samples>& other = context.Other();
    if (!other.ok()) return {NotMade(name, kName, p_.nrmse, p_.origin, other.failure())};
    const bool own_is_reference = context.solver() == "reference";
    const score::Series own = SeriesOf(context.samples(), context.rig(), p_.signal);
    const score::Series others = SeriesOf(*other, context.rig(), p_.signal);
    for (const auto& [counter, count] : own_is_reference ? context.samples().counters : other->counters) {
      context.figures["reference." + counter] = {static_cast<double>(count), "1"};
    }
    const auto who = own_is_reference ? std::pair("run", "realtime") : std::pair("reference", "run");
    return {CompareNrmse(context, p_.signal, own_is_reference ? own : others, own_is_reference ? others : own, who,
                         p_.nrmse, name, kName, p_.origin)};
  }

 private:
  Params p_;
};

/// The distance by which a scenario allows the two solvers to differ in a signal: the limit of its check of kind `solvers`, if any.
std::optional<double> SolversLimit(const Plan& plan, const std::string& signal) {
  const Value* checks = plan.root.Find("check");
  if (checks == nullptr || !checks->is_array()) return std::nullopt;
  for (const Value& check : checks->array()) {
    const Value *kind = check.Find("kind"), *of = check.Find("signal"), *nrmse = check.Find("nrmse");
    if (kind == nullptr || of == nullptr || nrmse == nullptr || !kind->is_string() || !of->is_string()) continue;
    if (kind->string() == SolversCheck::kName && of->string() == signal && nrmse->is_number()) return nrmse->number();
  }
  return std::nullopt;
}

/// A stated limit is that of `realtime`. `reference` may be farther off by what the solvers may be apart: the NRMSE of
/// both is over the same spread, so that the triangle inequality holds.
struct Limit {
  double nrmse;
  std::string origin;
};
Limit LimitFor(const CheckContext& context, const std::string& signal, double nrmse, const std::string& origin) {
  const std::optional<double> apart = SolversLimit(context.plan(), signal);
  if (context.solver() != "reference" || !apart) return {nrmse, origin};
  return {nrmse + *apart,
          fmt::format("{}; `reference` may be {:.3g} farther off, as the solvers may be apart", origin, *apart)};
}

class OracleCheck : public CheckPlan {
 public:
  struct Params {
    std::string oracle, signal, origin;
    double nrmse = 0.0, until_s = 0.0;
    void Visit(auto& v) {
      std::vector<std::string> names;
      for (const auto& [name, function] : oracles::All()) names.push_back(name);
      v.Required("oracle", oracle, names, "the independent reference (golden/oracles)");
      v.Required("signal", signal, Any(), "output that is compared");
      v.Required("nrmse", nrmse, Positive("1"),
                 "largest distance of `realtime`; `reference`: this and the limit of the signal's check `solvers`");
      v.Optional("until_s", until_s, NonNegative(), "compared up to here, where motion is chaotic; 0: to the end");
      v.Required("origin", origin, Any(), "why this limit");
    }
  };
  static constexpr const char* kName = "oracle";
  static constexpr bool kFollowsPlan = true;
  static constexpr const char* kRelativeLimits[] = {"nrmse"};
  static constexpr const char* kSummary = "the run against an independent reference";
  explicit OracleCheck(Params params) : p_(std::move(params)) {}
  std::vector<std::string> Signals() const override { return {p_.signal}; }

  std::vector<score::Check> Run(CheckContext& context) const override {
    const std::string name = fmt::format("{} {}", p_.oracle, p_.signal);
    const Limit limit = LimitFor(context, p_.signal, p_.nrmse, p_.origin);
    const Result<std::vector<double>> answer = context.Oracle(p_.oracle, p_.signal);
    if (!answer.ok()) return {NotMade(name, kName, limit.nrmse, limit.origin, answer.failure())};
    score::Series exact{context.samples().time, *answer};
    score::Series own = SeriesOf(context.samples(), context.rig(), p_.signal);
    if (p_.until_s > 0.0) {
      const auto rows = static_cast<std::size_t>(
          std::upper_bound(exact.time_s.begin(), exact.time_s.end(), p_.until_s) - exact.time_s.begin());
      for (score::Series* series : {&exact, &own}) {
        series->time_s = series->time_s.first(rows);
        series->values = series->values.first(rows);
      }
    }
    return {CompareNrmse(context, p_.signal, exact, own, {p_.oracle, "run"}, limit.nrmse, name, kName, limit.origin)};
  }

  void Applies(const Plan& plan, const Rig& rig, Diagnostics& diagnostics) const override {
    const std::string why = WhyNot(oracles::All().at(p_.oracle), plan, rig);
    if (why.empty()) return;
    std::string instead =
        "take kind = \"solvers\" instead, or \"windows\" where play or dry friction makes motion chaotic";
    for (const auto& [name, oracle] : oracles::All()) {
      if (WhyNot(oracle, plan, rig).empty()) instead = fmt::format("take oracle = \"{}\"", name);
    }
    diagnostics.Error(stated_at, fmt::format("the oracle \"{}\" {}", p_.oracle, why), instead,
                      "dynoproof describe check.oracle");
  }

 private:
  /// Why an oracle has no answer for this output; empty when it has.
  std::string WhyNot(const oracles::Oracle& oracle, const Plan& plan, const Rig& rig) const {
    oracles::Question question{plan.root, {}, {}, {p_.signal}};
    for (const InputLine& line : rig.inputs) question.inputs[line.name] = {};
    const Result<oracles::Answer> answer = oracle(question);
    return answer.ok() ? "" : answer.failure().message;
  }

  Params p_;
};

/// Reports a signal that the check looks at and the scenario does not have. `key`: where the check names it.
void NoSignal(const Value& table, const char* key, std::string fault, std::string instead, Diagnostics& diagnostics) {
  const Value* where = table.Find(key);
  diagnostics.Error(where != nullptr ? where->where() : table.where(), std::move(fault), std::move(instead));
}

/// Whether the scenario has what the check looks at; what is missing becomes an error.
bool HasWhatItNeeds(const CheckKind& kind, const CheckPlan& check, const Value& table, const Plan& plan, const Rig& rig,
                    Diagnostics& diagnostics) {
  const int before = diagnostics.error_count();
  if (kind.needs_analysis && plan.root.Find("analysis") == nullptr) {
    diagnostics.Error(table.where(), fmt::format("a check of kind \"{}\" needs the section [analysis]", kind.name),
                      "add [analysis] with input and output");
  }
  for (const std::string& input : check.Inputs()) {
    if (FindInput(rig, input) >= 0) continue;
    std::vector<std::string> names;
    for (const InputLine& line : rig.inputs) names.push_back(line.name);
    NoSignal(table, "reference", fmt::format("there is no input \"{}\" to follow", input),
             fmt::format("inputs: {}", fmt::join(names, ", ")), diagnostics);
  }
  for (const std::string& signal : check.Signals()) {
    if (FindOutput(rig, signal) >= 0) continue;
    std::vector<std::string> names;
    for (const OutputLine& line : rig.outputs) names.push_back(line.name);
    const std::optional<std::string> near = Closest(signal, names);
    NoSignal(table, "signal", fmt::format("there is no output \"{}\" to check", signal),
             near ? fmt::format("did you mean \"{}\"?", *near) : fmt::format("outputs: {}", fmt::join(names, ", ")),
             diagnostics);
  }
  return diagnostics.error_count() == before;
}

}  // namespace

void RegisterChecks(Registry& registry) {
  registry.AddCheck<FollowsCheck>();
  registry.AddCheck<GoldenCheck>();
  registry.AddCheck<OracleCheck>();
  registry.AddCheck<PeakCheck>();
  registry.AddCheck<ResonancesCheck>();
  registry.AddCheck<SolversCheck>();
  registry.AddCheck<WindowsCheck>();
}

std::vector<std::unique_ptr<CheckPlan>> ReadChecks(const Plan& plan, const Rig& rig, const Registry& registry,
                                                   Diagnostics& diagnostics) {
  std::vector<std::unique_ptr<CheckPlan>> checks;
  const Value* tables = plan.root.Find("check");
  if (tables == nullptr) return checks;
  if (!tables->is_array()) {
    diagnostics.Error(tables->where(), "\"check\" is " + tables->KindName(), "write [[check]]");
    return checks;
  }
  std::vector<std::string> names;
  for (const CheckKind* kind : registry.Checks()) names.push_back(kind->name);
  for (const Value& table : tables->array()) {
    const Value* name = table.Find("kind");
    if (name == nullptr || !name->is_string()) {
      diagnostics.Error(table.where(), "a check needs a \"kind\"", fmt::format("known: {}", fmt::join(names, ", ")));
      continue;
    }
    const CheckKind* kind = registry.FindCheck(name->string());
    if (kind == nullptr) {
      const std::optional<std::string> near = Closest(name->string(), names);
      diagnostics.Error(
          name->where(), fmt::format("there is no check of kind \"{}\"", name->string()),
          near ? fmt::format("did you mean \"{}\"?", *near) : fmt::format("known: {}", fmt::join(names, ", ")));
      continue;
    }
    std::unique_ptr<CheckPlan> check = kind->make(table, diagnostics);
    if (check == nullptr || !HasWhatItNeeds(*kind, *check, table, plan, rig, diagnostics)) continue;
    check->kind = kind->name;
    check->stated_at = name->where();
    checks.push_back(std::move(check));
  }
  return checks;
}

namespace {

/// Why a check cannot judge: a signal that it looks at has no samples, or one that is no number. Empty: it can.
std::string FaultOfSignals(const CheckPlan& check, const CheckContext& context) {
  std::vector<std::string> names = check.Signals();
  const std::vector<std::string> inputs = check.Inputs();
  names.insert(names.end(), inputs.begin(), inputs.end());
  for (const std::string& name : names) {
    std::string fault = score::FaultOf(SeriesOf(context.samples(), context.rig(), name), name);
    if (!fault.empty()) return fault;
  }
  return {};
}

}  // namespace

std::vector<score::Check> RunChecks(const std::vector<std::unique_ptr<CheckPlan>>& checks, CheckContext& context) {
  std::vector<score::Check> results;
  for (const auto& check : checks) {
    std::string fault = FaultOfSignals(*check, context);
    std::vector<score::Check> made;
    if (fault.empty()) {
      made = check->Run(context);
    } else {
      made.push_back(FailedCheck(check->kind.c_str(), check->kind, 0.0, "1",
                                 "what has no samples, or one that is no number, proves nothing", std::move(fault)));
    }
    if (made.empty()) made.emplace_back().name = "a check without a result";  // a fresh Check fails
    for (score::Check& one : made) {
      one.stated = check->kind;
      results.push_back(std::move(one));
    }
  }
  return results;
}

bool ChecksApply(const std::vector<std::unique_ptr<CheckPlan>>& checks, const Plan& plan, const Rig& rig,
                 Diagnostics& diagnostics) {
  const int before = diagnostics.error_count();
  for (const auto& check : checks) check->Applies(plan, rig, diagnostics);
  return diagnostics.error_count() == before;
}

}  // namespace dynoproof
