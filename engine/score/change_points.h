// Where the level of a recorded figure changed: night after night of one machine class.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace dynoproof::score {

struct LevelChange {
  std::size_t at = 0;                // the first value of the new level
  double before = 0.0, after = 0.0;  // medians of the levels
  double p = 0.0;                    // of a level change this clear without any; 0 for exact values
};

struct NoiseOptions {
  std::size_t least = 5;   // values a level has at least
  double alpha = 0.01;     // p below which a change counts; divide by the number of series looked at
  double relevant = 0.03;  // relative; smaller changes are nobody's business
  std::uint64_t seed = 1;
};

/// Changes of a figure that scatters (a time). Binary segmentation: the split with the largest standardised rank sum,
/// its p from random permutations of the stretch (the largest over all splits each), so that neither the scatter's law
/// nor the number of splits matters. Outliers carry no weight.
std::vector<LevelChange> NoisyChanges(std::span<const double> values, const NoiseOptions& options);
/// Whether `count` values can show a change at all: the clearest split's p against alpha.
bool CanDecide(std::size_t count, const NoiseOptions& options);

/// Changes of a figure that repeats exactly (an instruction count, a score): every value further than `relevant`
/// [absolute] from the first of its level begins a new one, so that a creep is found as well.
std::vector<LevelChange> ExactChanges(std::span<const double> values, double relevant);

}  // namespace dynoproof::score
