// The page of `dynoproof diagnose --html`: verdict, cause, gain, pictures before and after, and what was considered.
#pragma once

#include <string>
#include <vector>

#include "diagnosis/diagnose.h"
#include "experiment/pictures.h"

namespace dynoproof::reports {

std::string DiagnosisPage(const std::string& scenario, const std::vector<std::string>& records,
                          const diagnosis::Diagnosis& diagnosis, const std::vector<Picture>& pictures);

}  // namespace dynoproof::reports
