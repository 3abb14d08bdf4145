// Seeded random numbers without state: a number belongs to (seed, stream, index), so a run can be rewound, repeated and
// cut into pieces, and gives the same bits everywhere.
#pragma once

#include <cmath>
#include <cstdint>
#include <numbers>

namespace dynoproof {

/// A 64-bit hash of (seed, stream, index): SplitMix64's output function applied to each word in turn.
constexpr std::uint64_t RandomBits(std::uint64_t seed, std::uint64_t stream, std::uint64_t index) {
  std::uint64_t state = seed;
  for (const std::uint64_t word : {stream, index, std::uint64_t{0}}) {
    state += 0x9e3779b97f4a7c15u + word;
    state = (state ^ (state >> 30)) * 0xbf58476d1ce4e5b9u;
    state = (state ^ (state >> 27)) * 0x94d049bb133111ebu;
    state ^= state >> 31;
  }
  return state;
}

/// Uniform in the open interval (0, 1).
constexpr double RandomUniform(std::uint64_t seed, std::uint64_t stream, std::uint64_t index) {
  return (static_cast<double>(RandomBits(seed, stream, index) >> 11) + 0.5) * 0x1p-53;
}

/// Standard normal (Box-Muller).
inline double RandomNormal(std::uint64_t seed, std::uint64_t stream, std::uint64_t index) {
  const double radius = std::sqrt(-2.0 * std::log(RandomUniform(seed, stream, 2 * index)));
  return radius * std::cos(2.0 * std::numbers::pi * RandomUniform(seed, stream, 2 * index + 1));
}

}  // namespace dynoproof
