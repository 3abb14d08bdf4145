// Timing budgets of a scenario, [budget]: what a 100 us period may cost. Measured by `dynoproof bench`, never by `run`.
// Tails of wall-clock time bind only on a machine that proves fit in the same run; elsewhere they are inconclusive.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "base/status.h"
#include "model/params.h"
#include "model/plan.h"
#include "score/verdict.h"
#include "sim/rig.h"

namespace dynoproof {

/// Limits; 0: none stated.
struct Budget {
  double step_p50_us = 0.0, step_p999_us = 0.0, step_max_us = 0.0, simulated_s_per_s = 0.0;
  bool no_heap = false;
  void Visit(auto& v) {
    v.Optional("step_p50_us", step_p50_us, NonNegative("us"), "median time of a period's work");
    v.Optional("step_p999_us", step_p999_us, NonNegative("us"), "its 99.9th percentile; binds on a fit machine");
    v.Optional("step_max_us", step_max_us, NonNegative("us"), "its maximum; binds on a fit machine");
    v.Optional("simulated_s_per_s", simulated_s_per_s, NonNegative("1"), "simulated seconds per second, at least");
    v.Optional("no_heap", no_heap, Any(), "the heap must not grow during the steps");
  }
};
/// The plan's budget, when it states one; faults become diagnostics.
std::optional<Budget> ReadBudget(const Plan& plan, Diagnostics& diagnostics);

/// Whether this machine's clock can be trusted at all: how late it wakes, what the hypervisor took, whether the same
/// work takes the same time.
struct Fitness {
  double wake_p99_us = 0.0, stolen_share = 0.0, work_spread = 0.0;
  bool fit() const { return wake_p99_us <= 50.0 && stolen_share <= 0.01 && work_spread <= 0.2; }
  std::string Text() const;
};

struct Timing {
  std::vector<double> sorted_us;  // work of each period
  double simulated_s_per_s = 0.0;
  double heap_growth_bytes = 0.0;
  bool paced = false;
  std::int64_t overruns = 0;  // paced: periods whose work ended after the next one's begin
  double wake_p999_us = 0.0;  // paced: how late periods began
  Fitness fitness;
  std::vector<std::string> notes;
  double Quantile(double q) const;
};

struct BenchOptions {
  bool paced = false, realtime_priority = false;
  double most_s = 2.0;  // simulated
};

/// Steps the rig with its realtime solver and times every period.
Result<Timing> Measure(const Rig& rig, const BenchOptions& options);
/// Measured against stated: one check a limit; inconclusive where the machine cannot decide.
std::vector<score::Check> JudgeBudget(const Budget& budget, const Timing& timing);

}  // namespace dynoproof
