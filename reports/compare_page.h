// The page of `dynoproof compare --html`: two traces one over the other, what was judged, and where they part.
#pragma once

#include <string>

#include "experiment/run_scenario.h"
#include "trace/trace.h"

namespace dynoproof::reports {

/// `judged`: the checks of CompareTraces(), their verdict and notes. `a`, `b`: the files' names.
std::string ComparePage(const std::string& a, const std::string& b, const trace::Trace& reference,
                        const trace::Trace& test, const ScenarioResult& judged);

}  // namespace dynoproof::reports
