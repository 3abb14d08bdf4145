// Golden traces: what a run gave when a person last looked at it and said "this is right", thinned out to at most 200
// kB.
#pragma once

#include <map>
#include <string>

#include "base/status.h"
#include "experiment/golden_place.h"
#include "model/params.h"
#include "score/verdict.h"
#include "trace/trace.h"

namespace dynoproof {

/// The golden file <...>.toml: tolerances and where they come from.
struct GoldenTolerances {
  struct OfSignal {
    double relative_width = 1e-7;  // half-width of the tube over the signal's nominal
    double time_half_width_s = 0.0;
    std::string origin = "round-off of an exact solver; the rest is room for other vector instructions and compilers";
    void Visit(auto& v) {
      v.Required("relative_width", relative_width, Positive("1"), "half-width over the nominal");
      v.Optional("time_half_width_s", time_half_width_s, NonNegative(), "how much earlier or later");
      v.Required("origin", origin, Any(), "why");
    }
  };
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
  std::string reason;  // of the last bless
  OfRun run;
  std::map<std::string, OfSignal> signals;
};

/// The folder of the golden files: `golden` beside the scenario folder.
std::string GoldenFolder();

/// Reads [signal.NAME] tables and the reason from a TOML file.
Result<GoldenTolerances> ReadTolerances(const std::string& file);

/// The trace with every k-th sample of each signal (k the same prime for all), small enough to be kept. Pointwise
/// comparison at those samples is exact: thinning adds no error, what lies between is covered by the hull signals.
trace::Trace Thin(const trace::Trace& trace, std::size_t most_bytes = 180'000);

/// Compares a run with its golden files; one check per golden signal, one for signals that are new or gone. A missing
/// or unreadable golden file is a failed check.
std::vector<score::Check> CompareWithGolden(const GoldenPlace& place, const trace::Trace& run);

/// Where a run fell short of its golden trace: copies that to `kept`, so that the two lie side by side wherever the
/// output goes. Otherwise removes what an earlier run left there. Nothing to copy for a golden trace that does not
/// exist, or that lies there itself.
/// @return a note that names both and the command that compares them; empty when there is nothing to compare.
Result<std::string> KeepGolden(const GoldenPlace& place, bool fell_short, const std::string& trace_file,
                               const std::string& kept);

/// Writes the golden files from a run. Tolerances that stand there already are kept.
Status WriteGolden(const GoldenPlace& place, const trace::Trace& run, const std::string& reason);

/// Two traces signal by signal: missing, extra and short signals fail. `tolerance(name)` gives the tube.
std::vector<score::Check> CompareTraces(const trace::Trace& reference, const trace::Trace& test,
                                        const std::map<std::string, GoldenTolerances::OfSignal>& tolerances,
                                        const std::string& kind);

}  // namespace dynoproof
