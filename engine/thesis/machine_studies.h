// The studies of chapter 5 with the induction machine, for the claims ledger.
#pragma once

#include "thesis/studies.h"

namespace dynoproof {

std::map<std::string, Study, std::less<>> MachineStudies();

}  // namespace dynoproof
