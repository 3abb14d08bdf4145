// Diagnosis by corrected prediction: every candidate fitted beside the record, compared where a model leaves nothing but
// noise, else by what it explains of data that took no part. It stands beside Diagnose() until it is better.
#pragma once

#include <vector>

#include "diagnosis/diagnose.h"

namespace dynoproof::diagnosis {

/// As Diagnose(); `resume` and the budget do not apply: the work is the same for each record, some thousand simulations.
Result<Diagnosis> DiagnoseCorrected(const Plan& plan, const std::vector<MappedRecord>& data,
                                    const std::vector<MappedRecord>& holdout, const Registry& registry,
                                    const DiagnoseOptions& options);

}  // namespace dynoproof::diagnosis
