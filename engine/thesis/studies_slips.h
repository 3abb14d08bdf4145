// Studies of formulas whose print has slipped: one formula each, against a derivation that does not use it.
#pragma once

#include <map>
#include <string>

#include "thesis/studies.h"

namespace dynoproof {

std::map<std::string, Study, std::less<>> SlipStudies();

}  // namespace dynoproof
