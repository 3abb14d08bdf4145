// The studies of chapter 5 and its appendices, for the claims ledger.
#pragma once

#include "thesis/studies.h"

namespace dynoproof {

std::map<std::string, Study, std::less<>> SuppressionStudies();

}  // namespace dynoproof
