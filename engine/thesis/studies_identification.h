// Studies of identification: what a fit finds of a line in a record of its own run, which is synthetic.
#pragma once

#include <map>
#include <string>

#include "thesis/studies.h"

namespace dynoproof {

std::map<std::string, Study, std::less<>> IdentificationStudies();

}  // namespace dynoproof
