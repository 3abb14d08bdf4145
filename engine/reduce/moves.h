// Ways to make a scenario smaller: each takes something out of the tree, or puts something plainer in its place.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "model/value.h"

namespace dynoproof::reduce {

struct Move {
  std::string what;                        // "output.omega_1", "I2 is one with I3"
  std::function<bool(Value& root)> apply;  // false: there is nothing left to do it to
};

/// A group of moves that are tried together, then by halves.
struct Group {
  std::string what;  // "outputs and inputs"
  std::vector<Move> moves;
};

/// Groups in the order in which they pay: whole sections, signals and effects, parts with all that names them, what a rotor and a
/// stiff coupling hide, stages, single keys, digits. `kept`: signals that the check looks at.
std::vector<Group> GroupsOf(const Value& root, const std::vector<std::string>& kept);

/// What happens in the inputs, when the checks look, and the end of the run come at this share of their time.
Move Earlier(double factor);

/// The number in so many digits.
double Rounded(double value, int digits);

/// Does these moves one after the other; what they leave empty goes, too.
void Apply(const std::vector<Move>& moves, Value& root);

}  // namespace dynoproof::reduce
