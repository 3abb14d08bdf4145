// Ways to make a scenario smaller: each takes something out of the tree, or puts something plainer in its place.
#pragma once

#include <functional>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "model/value.h"
#include "trace/trace.h"

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

/// The average of each input of a run, and of each signal that its outputs show: "input.fuel" and "part.engine.torque" to a number.
using Levels = std::map<std::string, double>;
Levels LevelsOf(const Value& root, const trace::Trace& trace);

/// Groups in the order in which they pay: whole sections, signals and effects, parts with all that names them, what a rotor and a
/// stiff coupling hide, stages, single keys. `kept`: signals that the check looks at.
/// An input whose control goes rests at its level. `changed`: paths of the numbers that the good scenario has otherwise.
std::vector<Group> GroupsOf(const Value& root, const std::vector<std::string>& kept, const Levels& levels = {},
                            const std::set<std::string>& changed = {});

/// Numbers in so many digits, which fits more on a line; not those that are `changed`, for by how much is what is wrong.
Group Digits(const Value& root, int digits, const std::set<std::string>& changed = {});

/// Keys of the checks that have a default, and items of their lists. Without them the checks may say something else.
Group KeysOfChecks(const Value& root);

/// When the checks look for the last time: their largest instant, with their shortest stretch behind it where they name more than one
/// time; 0 where they name none.
double LastLookOf(const Value& root);

/// What happens in the inputs, when the checks look, and the end of the run come at this share of their time.
Move Earlier(double factor);

/// The number in so many digits.
double Rounded(double value, int digits);

/// Does these moves one after the other; what they leave empty goes, too.
void Apply(const std::vector<Move>& moves, Value& root);

}  // namespace dynoproof::reduce
