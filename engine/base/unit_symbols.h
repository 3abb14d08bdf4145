// The symbols and names of single units.
#pragma once

#include <optional>
#include <string_view>

#include "base/units.h"

namespace dynoproof {

/// The unit of one symbol or name, with or without a prefix: "kN", "mbar", "rpm", "Seconds", "millivolt". Symbols are
/// told apart by their case, as prefixes are (mN, MN); names written out, and the few abbreviations that no prefix can
/// be mistaken for, are not. Where two readings are possible the SI's holds: "g" is a gram, "m" a metre.
std::optional<Unit> SymbolOfUnit(std::string_view text);

}  // namespace dynoproof
