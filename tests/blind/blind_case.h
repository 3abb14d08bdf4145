// What a blind case is made of: its hidden truth, the numbers it is drawn by, and the columns of its record.
#pragma once

#include <algorithm>
#include <cstdint>
#include <map>
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

struct Case {
  std::string kind, scenario, effect, at, generator;
  std::vector<double> parameters;
  double strength = 1.0;           // share of what counts as a fault worth finding
  double noise = 0.0, size = 0.0;  // of the signals; effect over noise, as SizeOf() says
};

}  // namespace dynoproof::blind
