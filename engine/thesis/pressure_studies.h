// The studies of chapter 6, for the claims ledger.
#pragma once

#include "thesis/studies.h"

namespace dynoproof {

std::map<std::string, Study, std::less<>> PressureStudies();

}  // namespace dynoproof
