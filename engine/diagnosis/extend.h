// Scenario files that a diagnosis writes: the extended model, and the experiment that tells candidates apart.
#pragma once

#include <string>
#include <vector>

#include "base/status.h"
#include "diagnosis/diagnose.h"

namespace dynoproof::diagnosis {

/// `out`/extended.toml: the scenario by include, what it extends, the nominal values that were fitted along, and one
/// [[effect]] each.
Result<std::string> WriteExtended(const EstimationProblem& problem, const identification::Hypothesis& hypothesis,
                                  const Diagnosis& diagnosis, const DiagnoseOptions& options);

/// What would separate these candidates, in words; and `out`/separate.toml with that excitation.
std::string SeparatingText(const EstimationProblem& problem, const std::vector<EffectInstance>& alike);
Result<std::string> WriteSeparating(const EstimationProblem& problem, const std::vector<EffectInstance>& alike,
                                    const DiagnoseOptions& options);

}  // namespace dynoproof::diagnosis
