// The probe makes the model of a scenario wrong in each way that the program knows, and finds the strength from which a check fails.
#pragma once

#include <functional>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "base/status.h"
#include "experiment/prepare.h"
#include "probe/mutations.h"

namespace dynoproof::probe {

enum class State {
  kSeen,     // from `from` on
  kUnseen,   // not at any strength that was tried
  kNoTrace,  // unseen, and at its usual strength no output of the run changes by more than a millionth of its spread
  kRefused,  // no such model can be built: a reader sees it
};
std::string_view ToString(State state);

/// What became of one mutation.
struct Finding {
  std::string name, place, unit;
  int sign = 1;
  bool sized = false, falling = false;
  double usual = 0.0;  // the strength that such errors usually have
  State state = State::kUnseen;
  /// The strength from which a check fails: the geometric mean of the largest that passed and the least that failed, which are at
  /// most a tenth apart. Where no check ever fails, the largest strength that was tried.
  double strength = 0.0;
  bool at_once = false;  // seen at the least that was tried: the strength is that
  double size = 0.0;     // the same over what is usual; of a limit, on a logarithmic scale from where it does nothing
  EffectValues parameters = {};  // of the effect at that strength, as an [[effect]] takes them
  std::string by = {};           // the check that sees it there: the worst
  double moves =
      0.0;  // how far it moves an output where it is just not seen, RMS over that output's own spread: the largest
  /// By output, how far the usual strength moves it from where it would be: the largest distance over its nominal.
  std::map<std::string, double> reach = {};
  int runs = 0;

  /// A hole: what such errors usually have passes, and the run is another one.
  bool IsHole() const;
};

struct Options {
  /// Kinds of checks that are not asked: "golden" tells what would slip through where a wrong run is blessed.
  std::vector<std::string> without = {};
  std::vector<std::string> effects = {};  // these names alone; empty: all
  unsigned threads = 0;                   // 0: one a core
  double most_usual = 1000.0;             // beyond so many times the usual strength nobody looks
  double least_usual = 1e-3;              // nor below
  std::function<void(const Finding&, std::size_t done, std::size_t all)> found = {};  // as they come; one at a time
  std::vector<Finding> known = {};  // from an earlier call: not looked for again
};

/// What the probe asks of the scenario as it is.
struct Probed {
  std::vector<std::string> asked;    // names of the checks that take part
  std::vector<std::string> skipped;  // kinds that do not, with the reason
  std::vector<Finding> findings;     // by size, holes first
  int runs = 0;
  /// By output, how far the run of the other solver is from this one, over the nominal; looked at where there is a hole.
  std::map<std::string, double> apart = {};
};

/// The scenario must pass as it is, and some check must take part: else a failure with exit code 1.
Result<Probed> Probe(const Prepared& prepared, const Options& options);

}  // namespace dynoproof::probe
