// What a diagnosis has to show, as pictures: measured, simulated and extended courses, what is left before and after.
#pragma once

#include <string>
#include <vector>

#include "diagnosis/diagnose.h"
#include "diagnosis/terms.h"
#include "experiment/pictures.h"
#include "identification/estimation_problem.h"

namespace dynoproof::diagnosis {

/// Per measured output of every record, as far as the diagnosis counts it: the overlay, the residual and its spectrum;
/// and, for each output measured along with it, the residual's mean over that output's value, the non-parametric look,
/// with what the extension makes of it (extended - simulated) over it.
/// Everything starts as the records were found to. Without an extended scenario there is no "after". Fails where a run
/// breaks.
Result<std::vector<Picture>> Look(const Plan& nominal, const std::vector<MappedRecord>& records, const Diagnosis& found,
                                  const Registry& registry);

}  // namespace dynoproof::diagnosis
