// One scenario from start to verdict: simulate, write the trace, make the checks.
#pragma once

#include <functional>
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
  std::string broken;  // why, for a verdict of kBroken
  int exit_code = 3;   // of that failure
  std::vector<std::string> notes;
};

/// A simulated scenario: the samples, and the trace with everything that is derived from them.
struct Course {
  Samples samples;
  trace::Trace trace;
};

struct RunOptions {
  std::string out = "out";  // folder; traces go to out/<id>.h5; empty: none is written
  const MappedRecord* data = nullptr;
  Progress progress = {};
  /// Called with what there is to see when the checks have been made; not for a broken run.
  std::function<void(const Course&, CheckContext&, const ScenarioResult&)> seen = {};
};

ScenarioResult RunScenario(const Prepared& prepared, const RunOptions& options);

/// The simulation alone: no file, no checks. Outputs of variants are OUTPUT_VARIANT.
Result<Course> Play(const Prepared& prepared, const Progress& progress = {});

/// The trace of a run: commands, samples, hull of the analysed output, resolved scenario, provenance.
trace::Trace MakeTrace(const Prepared& prepared, const Samples& samples);

/// Version, commit, compiler: what every provenance begins with.
trace::Provenance BuildProvenance();

}  // namespace dynoproof
