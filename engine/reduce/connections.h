// What feeds what in a scenario: a part goes with all that names it, or what it fed is fed otherwise.
#pragma once

#include <string>
#include <vector>

#include "model/value.h"
#include "reduce/moves.h"

namespace dynoproof::reduce {

/// What the moves have to know beside the tree.
struct Known {
  std::vector<std::string> kept;  // signals that the check looks at
  Levels levels;
};

/// Everything that may name something else, or be named: "plant.inertia.I5", "control.core", "check.0".
std::vector<std::string> PartsOf(const Value& root);

/// A part goes with all that cannot be without it: with an inertia its shafts, what acts on it and what is seen of it. No move where
/// that takes what is kept.
Move WithAll(const std::string& path, const Known& known);

/// What machines and their controls drive takes what they are asked for, without them.
std::vector<Move> Shortcuts(const Value& root, const Known& known);

/// What a variant connects otherwise is connected so in all of the scenario: the parts that only the others need can go then.
std::vector<Move> Adoptions(const Value& root);

}  // namespace dynoproof::reduce
