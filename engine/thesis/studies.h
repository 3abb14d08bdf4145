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

/// Chapter 3 (studies_backlash.cc): a figure of the first impact in a scenario with play, and of one rigid mass
/// instead.
Result<Figure> BacklashImpact(const Registry& registry, const Value& parameters);
Result<Figure> BacklashRigidMass(const Registry& registry, const Value& parameters);
/// How far two laws with play are apart in a signal (omega_1 unless said) up to an impact of the first.
Result<Figure> BacklashLaws(const Registry& registry, const Value& parameters);
/// Lowest elastic frequency of a rotor cut in equal thirds, footnote 2 of chapter 3.
Result<Figure> RotorInThirds(const Registry& registry, const Value& parameters);

/// All studies by name.
const std::map<std::string, Study, std::less<>>& Studies();

}  // namespace dynoproof
