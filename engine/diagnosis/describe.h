// From a settled contest to a report: the cause with its numbers, what it gains, what is left, and the scenario with it in.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "diagnosis/contest.h"
#include "diagnosis/diagnose.h"
#include "diagnosis/parts.h"
#include "diagnosis/settle.h"

namespace dynoproof::diagnosis {

/// What a report is about.
struct Task {
  const EstimationProblem& problem;  // of the training data
  const Plan& begun;                 // the nominal plan, from where the records start
  const std::vector<MappedRecord>& data;
  const std::vector<MappedRecord>& holdout;  // empty: the last part of the data is that
  const DiagnoseOptions& options;
};

/// Fills in all but the verdict and its reason. `released`: the null with its nominal values released, where it was fitted.
/// `alike`: nominal values that account for the records as the causes do. Fails where a file cannot be written.
Status Describe(const Task& task, const Levels& levels, const Contest& contest, const Settled& settled,
                const std::optional<Contestant>& released, const std::vector<std::string>& alike, Diagnosis& result);

}  // namespace dynoproof::diagnosis
