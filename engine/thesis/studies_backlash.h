// Studies of chapter 3: play in a shaft.
#pragma once

#include "thesis/studies.h"

namespace dynoproof {

/// A figure of the first impact in a scenario with play, and of one rigid mass instead.
Result<Figure> BacklashImpact(const Registry& registry, const Value& parameters);
Result<Figure> BacklashRigidMass(const Registry& registry, const Value& parameters);
/// How far two laws with play are apart in a signal (omega_1 unless said) up to an impact of the first.
Result<Figure> BacklashLaws(const Registry& registry, const Value& parameters);
/// Lowest elastic frequency of a rotor cut in equal thirds, footnote 2 of chapter 3.
Result<Figure> RotorInThirds(const Registry& registry, const Value& parameters);

}  // namespace dynoproof
