// How deep the tables and lists of a scenario lie in one another, told from its text.
#pragma once

#include <optional>
#include <string_view>

namespace dynoproof {

/// The most levels of tables and lists: reading and walking through them takes a call for each, and calls need room.
constexpr int kMostLevels = 100;

/// The line in which a TOML text goes deeper than kMostLevels, by brackets or by the parts of a key (a.a.a); nothing if
/// none does. Such a text must not come to the parser, which limits brackets but not keys.
std::optional<int> LineTooDeep(std::string_view toml);

}  // namespace dynoproof
