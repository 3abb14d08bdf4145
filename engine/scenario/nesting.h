// How deep the tables and lists of a scenario lie in one another, told from its text.
#pragma once

#include <optional>
#include <string_view>

#include "model/value.h"

namespace dynoproof {

/// The most keys and places in lists that lead to a value: reading and walking through them takes a call for each, and
/// calls need room.
constexpr int kMostLevels = 100;

/// The first value that lies deeper than kMostLevels in a scenario; nullptr if none does. Notation makes no difference, so
/// that what was read can be written and read again.
const Value* ValueTooDeep(const Value& root);

/// The line in which a TOML text goes so deep, by brackets or by the parts of a key (a.a.a), that some value must lie
/// deeper than kMostLevels; nothing if none does. Such a text must not come to the parser, which limits brackets but not
/// keys. A table in braces counts twice here, by its key and by its brace.
std::optional<int> LineTooDeep(std::string_view toml);

}  // namespace dynoproof
