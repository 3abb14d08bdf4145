// Studies that hold what is printed against what it has to satisfy: tables against each other, and formulas whose print
// has slipped against a derivation that does not use them.
#pragma once

#include "thesis/studies.h"

namespace dynoproof {

/// Tables, sizes, and the forms of chapters 2, 3 and 5 that need a computation of some length.
std::map<std::string, Study, std::less<>> PrintedStudies();

}  // namespace dynoproof
