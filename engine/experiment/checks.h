// The checks a scenario states. A [[check]] table becomes a CheckPlan before the run and score::Checks after it.
#pragma once

#include <fmt/format.h>

#include <functional>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "base/status.h"
#include "experiment/golden_place.h"
#include "model/params.h"
#include "model/plan.h"
#include "score/series.h"
#include "score/verdict.h"
#include "sim/rig.h"
#include "sim/simulate.h"
#include "trace/trace.h"

namespace dynoproof {

struct Figure {
  double value;
  std::string unit;
};
using Figures = std::map<std::string, Figure>;

/// What a check may look at. The second solver's samples and the oracles' answers are computed once, when first asked.
class CheckContext {
 public:
  CheckContext(const Plan& plan, const Rig& rig, const Samples& samples, const std::string& solver)
      : plan_(plan), rig_(rig), samples_(samples), solver_(solver) {}

  const Plan& plan() const { return plan_; }
  const Rig& rig() const { return rig_; }
  const Samples& samples() const { return samples_; }
  const std::string& solver() const { return solver_; }
  /// Samples of the other solver.
  const Result<Samples>& Other();
  /// The same if a check has asked for them, else null.
  const Samples* OtherIfMade() const { return other_ != nullptr && other_->ok() ? &**other_ : nullptr; }
  /// The named oracle's answer for every output that some check asks it for.
  Result<std::vector<double>> Oracle(const std::string& oracle, const std::string& output);

  Figures figures;                      // what the checks found out besides their verdicts
  const trace::Trace* trace = nullptr;  // the run as it will be written
  const Registry* registry = nullptr;   // for checks that build variants of the scenario
  const Records* records = nullptr;
  GoldenPlace golden;  // what the golden check compares with

 private:
  const Plan& plan_;
  const Rig& rig_;
  const Samples& samples_;
  const std::string solver_;
  std::unique_ptr<Result<Samples>> other_;
  std::map<std::string, std::map<std::string, std::vector<double>>> answers_;
};

/// One check, understood and ready.
class CheckPlan {
 public:
  virtual ~CheckPlan() = default;
  /// At least one Check: a check that could not be made is a failed one that says why.
  virtual std::vector<score::Check> Run(CheckContext& context) const = 0;
  /// Reports why this scenario could never make the check, at `stated_at`, and what to state instead.
  virtual void Applies(const Plan&, const Rig&, Diagnostics&) const {}

  SourceSpan stated_at;  // its kind, in the file
};

/// Reads every [[check]] of the plan; faults become diagnostics.
std::vector<std::unique_ptr<CheckPlan>> ReadChecks(const Plan& plan, const Rig& rig, Diagnostics& diagnostics);

/// Whether every check can be made on the scenario that states it; what cannot is an error at its place. Asked before
/// anything runs: a check that does not happen proves nothing, and the run would be for nothing.
bool ChecksApply(const std::vector<std::unique_ptr<CheckPlan>>& checks, const Plan& plan, const Rig& rig,
                 Diagnostics& diagnostics);

/// What `describe` says of the kinds of checks: name, summary, parameters.
struct CheckKindInfo {
  std::string name, summary;
  std::vector<ParamInfo> parameters;
  std::vector<std::string> relative_limits = {};  // parameters that are a largest relative deviation
  bool compares_solvers = false;                  // `realtime` against `reference`
};
std::vector<CheckKindInfo> CheckKinds();

/// A kind of check: what it is, and how a [[check]] table becomes one; null when the table is faulty.
struct CheckKind {
  CheckKindInfo info;
  std::function<std::unique_ptr<CheckPlan>(const Value&, const Plan&, const Rig&, Diagnostics&)> make;
};
/// Makes a kind known to every scenario that is read from now on; one of the same name is replaced.
void AddCheckKind(CheckKind kind);

/// The index of an output or input of the rig by name, or -1.
int FindOutput(const Rig& rig, std::string_view name);
int FindInput(const Rig& rig, std::string_view name);

/// A signal of a run as the scores see it; `nominal` is set when not null.
score::Series SeriesOf(const Samples& samples, const Rig& rig, const std::string& signal, double* nominal = nullptr);

/// The check that could not be made, and why.
score::Check FailedCheck(const char* kind, std::string name, double limit, std::string unit, const std::string& origin,
                         std::string why);

/// RMS of the difference of an output over the spread of the reference, both on [from_s, to_s] of the same ticks; NaN
/// when the reference has no spread there.
double RelativeDistance(const Samples& reference, const Samples& test, int output, double from_s, double to_s);

template <class C>
CheckKindInfo CheckKindInfoOf() {
  CheckKindInfo info{C::kName, C::kSummary, ListParams<typename C::Params>()};
  if constexpr (requires { C::kRelativeLimits; })
    info.relative_limits.assign(std::begin(C::kRelativeLimits), std::end(C::kRelativeLimits));
  if constexpr (requires { C::kComparesSolvers; }) info.compares_solvers = C::kComparesSolvers;
  return info;
}

template <class C>
CheckKind MakeCheckKind() {
  return {CheckKindInfoOf<C>(),
          [](const Value& table, [[maybe_unused]] const Plan& plan, const Rig& rig,
             Diagnostics& diagnostics) -> std::unique_ptr<CheckPlan> {
            typename C::Params params;
            if (!ReadParams(table, params, diagnostics, fmt::format("check.{}", C::kName), {"kind"})) return nullptr;
            auto check = std::make_unique<C>(std::move(params));
            bool good = true;
            if constexpr (requires { C::kNeedsAnalysis; }) {
              if (plan.root.Find("analysis") == nullptr) {
                diagnostics.Error(table.where(),
                                  fmt::format("a check of kind \"{}\" needs the section [analysis]", C::kName),
                                  "add [analysis] with input and output");
                good = false;
              }
            }
            if constexpr (requires { check->Inputs(); }) {
              for (const std::string& input : check->Inputs()) {
                if (FindInput(rig, input) >= 0) continue;
                std::vector<std::string> names;
                for (const InputLine& line : rig.inputs) names.push_back(line.name);
                const Value* where = table.Find("reference");
                diagnostics.Error(where != nullptr ? where->where() : table.where(),
                                  fmt::format("there is no input \"{}\" to follow", input),
                                  fmt::format("inputs: {}", fmt::join(names, ", ")));
                good = false;
              }
            }
            for (const std::string& signal : check->Signals()) {
              if (FindOutput(rig, signal) >= 0) continue;
              std::vector<std::string> names;
              for (const OutputLine& line : rig.outputs) names.push_back(line.name);
              const std::optional<std::string> near = Closest(signal, names);
              const Value* where = table.Find("signal");
              diagnostics.Error(where != nullptr ? where->where() : table.where(),
                                fmt::format("there is no output \"{}\" to check", signal),
                                near ? fmt::format("did you mean \"{}\"?", *near)
                                     : fmt::format("outputs: {}", fmt::join(names, ", ")));
              good = false;
            }
            return good ? std::move(check) : nullptr;
          }};
}

}  // namespace dynoproof
