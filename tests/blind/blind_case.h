// What a blind case is made of: its hidden truth, the numbers it is drawn by, and the columns of its record.
#pragma once

#include <algorithm>
#include <cstdint>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "base/random.h"

namespace dynoproof::blind {

/// Numbers of one case, in the order they are asked for.
class Dice {
 public:
  // Neighbouring seeds must not share cases: the hash adds seed and number.
  Dice(std::uint64_t seed, std::uint64_t number) : seed_(seed * 1000003), number_(number) {}
  double Uniform(double low, double high) { return low + (high - low) * RandomUniform(seed_, number_, next_++); }
  double Sign() { return Uniform(0, 1) < 0.5 ? -1.0 : 1.0; }
  double Normal() { return RandomNormal(seed_, number_, 1000000 + next_++); }
  std::size_t Index(std::size_t count) {
    return std::min(count - 1, static_cast<std::size_t>(Uniform(0.0, static_cast<double>(count))));
  }

 private:
  std::uint64_t seed_, number_, next_ = 0;
};

struct Columns {
  std::vector<double> time;
  std::map<std::string, std::vector<double>> inputs, outputs;
};

/// An effect that was hidden, as the contract names it.
struct Cause {
  std::string effect, at;
  std::vector<double> parameters;
};

struct Case {
  std::string kind, scenario, generator;  // kind: effect, pair, null, decoy or unknown
  std::vector<Cause> causes;
  std::string unknown;             // what is hidden that is not in the contract's list
  double strength = 1.0;           // share of what counts as a fault worth finding
  double noise = 0.0, size = 0.0;  // of the signals; effect over noise, as SizeOf() says
  // What makes the record unlike any model (inexact.h), its own size, and places whose effects stand for it.
  std::vector<std::string> inexact;
  double inexact_size = 0.0;
  std::set<std::string> near;
  bool any_friction = false;  // every dry friction at the cause's place is the cause

  bool IsInexactBy(const char* what) const { return std::find(inexact.begin(), inexact.end(), what) != inexact.end(); }
};

/// A case counts from here on.
inline constexpr double kSmallestSize = 3.0;

/// RMS of the difference over the noise, of the signal that shows most; of the training part or the hold-out (the last
/// 30 %), whichever shows less: nobody finds what one of them does not hold.
double SizeOf(const Columns& with, const Columns& without, double noise);

}  // namespace dynoproof::blind
