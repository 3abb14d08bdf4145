// One scenario from start to verdict: simulate, write the trace, make the checks.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <string>
#include <vector>

#include "experiment/checks.h"
#include "experiment/prepare.h"
#include "score/verdict.h"
#include "trace/trace.h"

namespace dynoproof {

struct ScenarioResult {
  std::string id, title;
  score::Verdict verdict = score::Verdict::kFail;
  std::string trace_file;  // empty when none was written
  std::vector<score::Check> checks;
  Figures figures;
  std::map<std::string, std::int64_t> counters;  // of the solver: steps, events, ...
  std::string broken;                            // why, for a verdict of kBroken
  int exit_code = 3;                             // of that failure
  std::vector<std::string> notes;
  // What to suspect first: "by --set: plant.inertia.I3 = 0.6 (was 0.5)", "modes moved from ...".
  std::vector<std::string> changes;
};

/// A simulated scenario: the samples, and the trace with everything that is derived from them.
struct Course {
  Samples samples;
  trace::Trace trace;
  StepTimes times = {};  // of its periods, where they were asked for
};

struct RunOptions {
  std::string out = "out";             // folder; traces go to out/<id>.h5; empty: none is written
  const MappedRecord* data = nullptr;  // --data: its comparison takes the place of the scenario's checks
  std::string today = {};              // for accepted gaps, "2026-01-31"; empty: by the clock
  std::string kept = {};               // folder of kept samples of `reference` (kept_reference.h); empty: none are
  Progress progress = {};
  /// Called with what there is to see when the checks have been made, which have their evidence then; not for a broken
  /// run.
  std::function<void(const Course&, const ScenarioResult&)> seen = {};
};

ScenarioResult RunScenario(const Prepared& prepared, const RunOptions& options);

/// The simulation alone: no file, no checks. Outputs of variants are OUTPUT_VARIANT.
Result<Course> Play(const Prepared& prepared, const Progress& progress = {}, bool timed = false);

/// Commands and samples alone, without scenario and provenance.
trace::Trace SampledTrace(const Rig& rig, const Samples& samples);

/// The trace of a run: commands, samples, hull of the analysed output, resolved scenario, provenance.
trace::Trace MakeTrace(const Prepared& prepared, const Samples& samples);

/// Version, commit, compiler: what every provenance begins with.
trace::Provenance BuildProvenance();

}  // namespace dynoproof
