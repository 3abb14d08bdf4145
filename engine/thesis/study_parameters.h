#pragma once
// The parameters of a claim, as its study reads them.

#include <string>

#include "base/status.h"
#include "model/value.h"

namespace dynoproof {

/// The failure of a study because of its parameters (exit code 2).
Failure BadStudy(std::string why);

/// A number of the claim's table.
Result<double> Number(const Value& parameters, const char* key);
/// A switch of the claim's table; off where it is not there.
bool Flag(const Value& parameters, const char* key);

}  // namespace dynoproof
