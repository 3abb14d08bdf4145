// A scenario in a process of its own: what a plugin does to the program, it does to that process alone.
#pragma once

#include <cstddef>
#include <functional>
#include <string>
#include <vector>

#include "experiment/run_scenario.h"
#include "reports/run_page.h"

namespace dynoproof::app {

struct RunLimits {
  double most_seconds = 0.0;    // of a scenario; 0: none
  double most_memory_MB = 0.0;  // of address space that it may add; 0: none
};

/// The result of a scenario that came to none.
ScenarioResult BrokenResult(std::string id, std::string why);

/// The results of `count` scenarios, `jobs` at a time, in order: `make(i)` runs in a fork, and adds what there is to see to `page`
/// there, from where both come back. A crash, an end of the program, more time or memory than the limits allow are that
/// scenario's result, kBroken with the reason; `id(i)` names it. `took` is called with each as it comes. Call it where no other thread
/// holds a lock.
std::vector<ScenarioResult> RunApart(std::size_t count, int jobs, const RunLimits& limits, reports::RunPage& page,
                                     const std::function<std::string(std::size_t)>& id,
                                     const std::function<ScenarioResult(std::size_t)>& make,
                                     const std::function<void(std::size_t, const ScenarioResult&)>& took);

}  // namespace dynoproof::app
