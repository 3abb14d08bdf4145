// The tree that moves change: marks at what is gone, and tables by their path.
#pragma once

#include <set>
#include <string>
#include <string_view>

#include "model/value.h"
#include "reduce/moves.h"

namespace dynoproof::reduce {

/// Stands for an item of a list that is gone, so that the others keep their numbers until all moves are done.
inline constexpr const char* kGone = "\x01gone";
bool IsGone(const Value& value);

/// Takes out what is marked as gone, and what is empty then.
void Sweep(Value& value);

/// A move that marks the value at a path as gone.
Move Without(const std::string& path);

/// The body of an end: "I1" of "I1.left".
std::string BodyOf(std::string_view end);

/// The entries of the table there; none where there is no table.
const Value::Table& TableAt(const Value& root, std::string_view path);

/// The items of the list there; none where there is no list.
const Value::Array& ListAt(const Value& root, std::string_view path);

/// The paths below `path` of the numbers that both trees have there, and that are others.
std::set<std::string> DifferingNumbers(const Value& a, const Value& b, const std::string& path);

}  // namespace dynoproof::reduce
