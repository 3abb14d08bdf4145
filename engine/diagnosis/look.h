// What a diagnosis has to show, as pictures: measured, simulated and extended courses, what is left before and after.
#pragma once

#include <string>
#include <vector>

#include "diagnosis/study.h"
#include "experiment/pictures.h"

namespace dynoproof::diagnosis {

/// Per measured output of every record: the overlay, the residual and its spectrum; and, for each output measured along
/// with it, the residual's mean over that output's value, the non-parametric look. `extended_file` may be empty: then
/// there is no "after". Fails where the nominal run breaks.
/// `until`: share of the records that is shown.
Result<std::vector<Picture>> Look(const Plan& nominal, const std::vector<MappedRecord>& records, double until,
                                  const std::string& extended_file, const Registry& registry);

}  // namespace dynoproof::diagnosis
