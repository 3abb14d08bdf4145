// Golden traces: what a run gave when a person last looked at it and said "this is right", thinned out to at most 200
// kB.
#pragma once

#include <string>

#include "base/status.h"
#include "experiment/check.h"
#include "experiment/compare_traces.h"
#include "experiment/golden_place.h"
#include "model/params.h"
#include "model/plan.h"
#include "score/verdict.h"
#include "trace/trace.h"

namespace dynoproof {

/// The golden file <...>.toml: tolerances and where they come from.
struct GoldenTolerances {
  using OfSignal = SignalTolerance;
  /// What thinning hides: how long the run was, and what it cost the solver.
  struct OfRun {
    std::int64_t samples = 0;
    double end_s = 0.0;
    std::string solver;
    std::vector<std::pair<std::string, double>> counters;
    void Visit(auto& v) {
      v.Required("samples", samples, Positive("1"), "samples of the main time base");
      v.Required("end_s", end_s, NonNegative(), "its last time");
      v.Required("solver", solver, Any(), "the solver of the run");
      v.Optional("counters", counters, NonNegative("1"), "its counters, golden within 10 %");
    }
  };
  std::string reason;               // of the last bless
  std::string trace_sha256;         // of the golden trace that these tolerances belong to; empty: an older file
  std::vector<std::string> checks;  // StatedChecks() when it was blessed; empty: an older file
  OfRun run;
  SignalTolerances signals;

  /// Tolerances for a run of this solver: those of the other solver where that is not the one of the golden run. A file
  /// of tolerances alone, without a golden run, has the same for both.
  SignalTolerances For(const std::string& solver) const;
};

/// The checks that a scenario states, each as its kind and what it is about: "solvers T_shaft". Sorted.
std::vector<std::string> StatedChecks(const Plan& plan);

/// The folder of the golden files: $DYNOPROOF_GOLDEN, else `golden` beside the scenario folder.
std::string GoldenFolder();

/// Reads [signal.NAME] tables and the reason from a TOML file.
Result<GoldenTolerances> ReadTolerances(const std::string& file);

/// Whether the tolerances were written for this trace file.
bool IsGoldenPair(const GoldenTolerances& tolerances, const std::string& trace_file);

/// Compares a run of `plan` with its golden files; one check per golden signal, one for signals that are new or gone,
/// one for checks that the scenario no longer states. A missing or unreadable golden file, or a trace that is not the
/// one of the tolerance file, is a failed check.
std::vector<score::Check> CompareWithGolden(const GoldenPlace& place, const Plan& plan, const trace::Trace& run);

/// The scenario that the golden trace holds; nothing where there is no such file, or none in it. A file that cannot be read, be it
/// for want of memory, is a failure: who asks whether there is one must not take it for none.
Result<std::optional<Value>> BlessedScenario(const GoldenPlace& place);

/// Each value in which the plan differs from the scenario that the golden trace holds: "plant.inertia.I4 = 0.1507 (was 0.137)".
/// Checks, budgets, title and source are not compared. Empty where there is no golden trace that can be read.
std::vector<std::string> ChangedSinceBlessed(const GoldenPlace& place, const Plan& plan);

/// Whether a scenario with these StatedChecks() compares with its golden data.
bool ComparesWithGolden(const std::vector<std::string>& stated);

/// Whether the check is of the run and its golden data.
bool IsOfGolden(const score::Check& check);

/// A scenario that has golden data and no check of kind `golden` compares nothing with them: a failed check then.
std::optional<score::Check> GoldenNotStated(const GoldenPlace& place, const Plan& plan);

/// Where a run fell short of its golden trace: copies that to `kept`, so that the two lie side by side wherever the
/// output goes. Otherwise removes what an earlier run left there. Nothing to copy for a golden trace that does not
/// exist, or that lies there itself.
/// @return a note that names both and the command that compares them; empty when there is nothing to compare.
Result<std::string> KeepGolden(const GoldenPlace& place, bool fell_short, const std::string& trace_file,
                               const std::string& kept);

/// A run that becomes golden, and the same of the other solver, which tells how far that may be.
struct GoldenRun {
  const trace::Trace& own;
  const trace::Trace& other;
  std::vector<std::string> checks;
  std::string reason;
};
/// Writes the golden files. Tolerances that stand there already are kept, but for those of the other solver, which
/// are what the two are apart now.
Status WriteGolden(const GoldenPlace& place, const GoldenRun& run);

/// The run against the golden trace of the scenario, with its tolerances (golden_place.h).
class GoldenCheck : public CheckPlan {
 public:
  struct Params {
    void Visit(auto&) {}
  };
  static constexpr const char* kName = "golden";
  static constexpr const char* kSummary =
      "the trace against the golden one that `bless` keeps, within the tolerances beside that";
  explicit GoldenCheck(Params) {}
  std::vector<std::string> Signals() const override { return {}; }
  std::vector<score::Check> Run(CheckContext& context) const override;
};

}  // namespace dynoproof
