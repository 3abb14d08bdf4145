// Physical units: what may be converted into what, and by which factor.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <string_view>

namespace dynoproof {

/// A unit as factor to SI and exponents of kg, m, s, K, A, rad. value_SI = factor * value + offset.
/// rad is kept as a dimension of its own so that Nm/rad and Nm are told apart; see SameQuantity.
struct Unit {
  double factor = 1.0;
  double offset = 0.0;                // degC and degF only
  std::array<int, 6> exponents = {};  // kg, m, s, K, A, rad
};

/// Parses products and quotients such as "N m", "kN m", "N·m/rad", "kg m²", "rad/s", "1/min", "min^-1", "m/s2", "%",
/// "°C", "ft-lb", "Volt", "1" (symbols: base/unit_symbols.h). Nothing for an unknown unit, and for "a/b/c" and "a/b c",
/// which may mean two things.
std::optional<Unit> ParseUnit(std::string_view text);

/// True when values of `a` can be converted into `b`. Radians are dimensionless in this comparison.
bool SameQuantity(const Unit& a, const Unit& b);

/// The unit that a key or name carries as suffix: "stiffness_Nm_per_rad" -> "N m/rad", "period_s" -> "s"; "1" without.
std::string UnitOfSuffix(std::string_view name);

}  // namespace dynoproof
