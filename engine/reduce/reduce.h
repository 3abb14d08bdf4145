// The smallest scenario that still fails the same check for the same cause: delta debugging over the tree of values, with the
// moves of a drive line first.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "base/status.h"
#include "model/plan.h"
#include "model/registry.h"
#include "score/verdict.h"
#include "trace/trace.h"

namespace dynoproof::reduce {

struct Options {
  std::string check = {};  // its name as `run` shows it, or its kind; empty: the one that is furthest beyond its limit
  /// The scenario without the change that is suspected, as without --set: it loses the same, and must go on passing the check.
  std::optional<Plan> good = {};
  /// Whether another program passes that check of a plan, as the release before the fault: what it fails as well is another fault.
  /// Empty: nobody is asked.
  std::function<bool(const Plan& plan, const std::string& check)> sound = {};
  /// Its trace of a plan: what a golden check compares with where this program no longer gives the golden trace for the scenario that
  /// was blessed. Empty: only the run gets shorter then.
  std::function<std::optional<trace::Trace>(const Plan& plan)> sound_trace = {};
  int most_runs = 100;  // of either program; what is left then stands
  std::function<void(const std::string& what, int runs)> progress = {};
};

/// What was taken out, in one step that kept the fault.
struct Step {
  std::string what;
  std::size_t lines = 0;  // of the scenario afterwards
  double seconds = 0.0;   // its simulated time
};

struct Reduced {
  Plan plan;
  /// Of a golden check: the scenario that was blessed, with the same taken out. `plan` differs from what this one gives.
  std::optional<Plan> before;
  bool beside_sound = false;     // of a golden check: the other program's run of `plan` is the golden one
  std::string check;             // the name of the one that fails
  score::Check first, last;      // as it was, and as it is in `plan`
  std::size_t lines_before = 0;  // of the scenario in one file, as ToToml() writes it, without empty ones
  std::size_t values_before = 0;
  double seconds_before = 0.0;
  int runs = 0;
  bool complete = true;  // nothing more could be taken out; false: most_runs came first
  std::vector<Step> steps;
};

/// A golden check is one of two scenarios, the one that was blessed and the present one: both lose the same, and what is compared are
/// their runs. Where this program no longer gives the golden trace, the other program's run takes its place, or only the run gets
/// shorter.
///
/// The fault is the same one where the check of the same name (whatever numbers stand in it) fails in the same way: by a number
/// that is not more than ten times as far beyond its limit, or not made for the same reason, or the run breaks with the same
/// words. And where there is a scenario that passes it (`good`, or the one that was blessed), what is left of that passes it, too. A
/// failure with exit code 1 where nothing fails, or no such check.
Result<Reduced> Reduce(Plan plan, const Registry& registry, const Options& options);

}  // namespace dynoproof::reduce
