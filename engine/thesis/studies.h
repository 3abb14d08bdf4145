// Named computations behind the claims ledger: each turns the parameters of a claim into one figure.
#pragma once

#include <map>
#include <string>

#include "base/status.h"
#include "experiment/checks.h"
#include "model/registry.h"

namespace dynoproof {

/// One study: `parameters` is the claim's `compute` table. Fails (exit code 2) on missing or wrong parameters.
using Study = Result<Figure> (*)(const Registry& registry, const Value& parameters);

/// All studies by name.
const std::map<std::string, Study, std::less<>>& Studies();

}  // namespace dynoproof
