// Scenario files that a diagnosis writes: the extended model, and the experiment that tells candidates apart.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "base/status.h"
#include "diagnosis/diagnose.h"

namespace dynoproof::diagnosis {

/// `out`/extended.toml: the scenario by include, what it extends, the nominal values that were fitted along, and one
/// [[effect]] each.
Result<std::string> WriteExtended(const EstimationProblem& problem, const identification::Hypothesis& hypothesis,
                                  const Diagnosis& diagnosis, const DiagnoseOptions& options);

/// Whether an extension is not to be offered: it takes nothing off what the model as given leaves on data that took no part.
/// A model that leaves nothing but noise (`exact`) is worse by chance only.
bool IsNoBetterThanGiven(const std::optional<Share>& explained, bool exact);
/// `out`/extended.toml of an earlier diagnosis says nothing of this one.
void RemoveExtended(const DiagnoseOptions& options);

/// What would separate these candidates, in words; and `out`/separate.toml with that excitation.
std::string SeparatingText(const EstimationProblem& problem, const std::vector<EffectInstance>& alike);
Result<std::string> WriteSeparating(const EstimationProblem& problem, const std::vector<EffectInstance>& alike,
                                    const DiagnoseOptions& options);

}  // namespace dynoproof::diagnosis
