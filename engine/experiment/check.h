// A kind of check: what it may look at, what it must declare, what it gives. Public: a kind of check may stand in a
// shared library (dynoproof new check NAME), and registers there as those of the program do:
//
//   DYNOPROOF_PLUGIN(registry) { registry.AddCheck<MyCheck>(); }
//
// MyCheck derives from CheckPlan, is built from its Params (model/params.h) and declares kName and kSummary; if they
// apply also kRelativeLimits (keys of limits that are relative deviations), kComparesSolvers, kFollowsPlan and kNeedsAnalysis.
#pragma once

#include <iterator>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "base/status.h"
#include "model/params.h"
#include "model/plan.h"
#include "model/registry.h"
#include "score/evidence.h"
#include "score/series.h"
#include "score/verdict.h"

namespace dynoproof {

namespace trace {
struct Trace;
}
class KeptReference;
struct GoldenPlace;
struct Samples;

struct Figure {
  double value;
  std::string unit;
};
using Figures = std::map<std::string, Figure>;

/// An input or output of a run: its samples (inputs are held between them), unit and typical magnitude.
struct RunSignal {
  score::Series series;
  std::string unit;
  double nominal = 1.0;
};

/// What a check may look at.
class CheckContext {
 public:
  CheckContext(const Plan& plan, const Rig& rig, const Samples& samples, const std::string& solver);
  ~CheckContext();

  const Plan& plan() const { return plan_; }
  /// The solver of the run: "realtime" or "reference".
  const std::string& solver() const { return solver_; }
  /// The input or output of that name; nothing when the scenario has none.
  std::optional<RunSignal> Find(const std::string& name) const;

  Figures figures;  // what the checks found out besides their verdicts

  // What the program's own kinds ask for besides; the headers of these types are not public. The second solver's
  // samples and the oracles' answers are computed once, when first asked for.
  const Rig& rig() const { return rig_; }
  const Samples& samples() const { return samples_; }
  /// Samples of the other solver: those of `kept` where they still stand.
  const Result<Samples>& Other();
  /// The named oracle's answer for every output that some check asks it for.
  Result<std::vector<double>> Oracle(const std::string& oracle, const std::string& output);

  const trace::Trace* trace = nullptr;  // the run as it will be written
  const Registry* registry = nullptr;   // for checks that build variants of the scenario
  const Records* records = nullptr;
  const GoldenPlace* golden = nullptr;  // what the golden check compares with
  const KeptReference* kept = nullptr;  // where the samples of `reference` stay from run to run
  std::string kept_note;                // that they were taken, or could not be written

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
  /// At least one Check: a check that could not be made is a failed one that says why. One that compares two courses
  /// hands on its evidence.
  virtual std::vector<score::Check> Run(CheckContext& context) const = 0;
  /// Outputs and inputs that must exist; a scenario without them is at fault before anything runs.
  virtual std::vector<std::string> Signals() const { return {}; }
  virtual std::vector<std::string> Inputs() const { return {}; }
  /// Reports why this scenario could never make the check, at `stated_at`, and what to state instead.
  virtual void Applies(const Plan&, const Rig&, Diagnostics&) const {}

  std::string kind;      // its name in the registry
  SourceSpan stated_at;  // of that name, in the file

  /// C as the registry keeps it.
  template <class C>
  static CheckKind KindOf() {
    CheckKind kind{
        .name = C::kName, .summary = C::kSummary, .parameters = ListParams<typename C::Params>(), .make = {}};
    if constexpr (requires { C::kRelativeLimits; })
      kind.relative_limits.assign(std::begin(C::kRelativeLimits), std::end(C::kRelativeLimits));
    if constexpr (requires { C::kComparesSolvers; }) kind.compares_solvers = C::kComparesSolvers;
    if constexpr (requires { C::kFollowsPlan; }) kind.follows_plan = C::kFollowsPlan;
    if constexpr (requires { C::kNeedsAnalysis; }) kind.needs_analysis = C::kNeedsAnalysis;
    kind.make = [](const Value& table, Diagnostics& diagnostics) -> std::unique_ptr<CheckPlan> {
      typename C::Params params;
      if (!ReadParams(table, params, diagnostics, std::string("check.") + C::kName, {"kind"})) return nullptr;
      return std::make_unique<C>(std::move(params));
    };
    return kind;
  }
};

}  // namespace dynoproof
