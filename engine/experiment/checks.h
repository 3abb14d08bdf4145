// The checks a scenario states. A [[check]] table becomes a CheckPlan before the run and score::Checks after it.
#pragma once

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

/// The index of an output or input of the rig by name, or -1.
int FindOutput(const Rig& rig, std::string_view name);
int FindInput(const Rig& rig, std::string_view name);

/// A signal of a run as the scores see it; `nominal` is set when not null.
score::Series SeriesOf(const Samples& samples, const Rig& rig, const std::string& signal, double* nominal = nullptr);

}  // namespace dynoproof
