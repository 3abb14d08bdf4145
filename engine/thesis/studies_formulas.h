// Studies of formulas and data sheets that hold as printed, or fail at single points: each by its definition, without the
// engine's own version.
#pragma once

#include <map>
#include <string>

#include "thesis/studies.h"

namespace dynoproof {

std::map<std::string, Study, std::less<>> FormulaStudies();

}  // namespace dynoproof
