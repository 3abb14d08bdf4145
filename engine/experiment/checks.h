// The checks a scenario states. A [[check]] table becomes a CheckPlan before the run and score::Checks after it.
#pragma once

#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "experiment/check.h"
#include "sim/rig.h"
#include "sim/simulate.h"
#include "trace/trace.h"

namespace dynoproof {

/// Registers every kind of check of the harness.
void RegisterChecks(Registry& registry);

/// Reads every [[check]] of the plan; faults become diagnostics.
std::vector<std::unique_ptr<CheckPlan>> ReadChecks(const Plan& plan, const Rig& rig, const Registry& registry,
                                                   Diagnostics& diagnostics);

/// Makes the checks one after the other; each result says what kind stated it. One that says nothing is a failed one, and
/// so is one whose signals have no samples, or one that is not finite: no kind is asked then.
std::vector<score::Check> RunChecks(const std::vector<std::unique_ptr<CheckPlan>>& checks, CheckContext& context);

/// Whether every check can be made on the scenario that states it; what cannot is an error at its place. Asked before
/// anything runs: a check that does not happen proves nothing, and the run would be for nothing.
bool ChecksApply(const std::vector<std::unique_ptr<CheckPlan>>& checks, const Plan& plan, const Rig& rig,
                 Diagnostics& diagnostics);

/// The index of an output or input of the rig by name, or -1.
int FindOutput(const Rig& rig, std::string_view name);
int FindInput(const Rig& rig, std::string_view name);

/// A signal of a run as the scores see it; `nominal` is set when not null.
score::Series SeriesOf(const Samples& samples, const Rig& rig, const std::string& signal, double* nominal = nullptr);

/// The check that could not be made, and why.
score::Check FailedCheck(const char* kind, std::string name, double limit, std::string unit, const std::string& origin,
                         std::string why);

/// RMS of the difference of an output over the spread of the reference, both on [from_s, to_s] of the same ticks; NaN
/// when the reference has no spread there.
double RelativeDistance(const Samples& reference, const Samples& test, int output, double from_s, double to_s);

}  // namespace dynoproof
