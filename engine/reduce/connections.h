// Connections of a scenario's parts: a part goes with all that names it, or its consumers are fed otherwise.
#pragma once

#include <string>
#include <vector>

#include "model/value.h"
#include "reduce/moves.h"

namespace dynoproof::reduce {

/// Knowledge of the moves beside the tree.
struct Known {
  std::vector<std::string> kept;  // signals that the check looks at
  Levels levels;
};

/// Everything that may name something else, or be named: "plant.inertia.I5", "control.core", "check.0".
std::vector<std::string> PartsOf(const Value& root);

/// A part goes with all that cannot be without it: with an inertia its shafts, what acts on it and what is seen of it. No move where
/// that takes what is kept.
Move WithAll(const std::string& path, const Known& known);

/// Machines and their controls go: their load takes the torque that they are asked for.
std::vector<Move> Shortcuts(const Value& root, const Known& known);

/// The whole scenario is connected as one of its variants is: the parts that only the others need can go then.
std::vector<Move> Adoptions(const Value& root);

}  // namespace dynoproof::reduce
