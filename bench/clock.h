// What a nanosecond is worth here and now: clocks of shared machines differ and wander, cycles compare.
#pragma once

#include <benchmark/benchmark.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <limits>

namespace dynoproof {

/// The chain's clock in GHz: 64 000 `instruction`s of which each waits for the one before, `cycles` each; the best of
/// five tries, for what disturbs only ever slows.
#define DYNOPROOF_CHAIN_GHZ(instruction, cycles)                                                            \
  [] {                                                                                                      \
    double best = 0.0;                                                                                      \
    for (int i = 0; i < 5; ++i) {                                                                           \
      const auto begin = std::chrono::steady_clock::now();                                                  \
      std::uint64_t x = 3;                                                                                  \
      const std::uint64_t y = 5;                                                                            \
      for (int k = 0; k < 1000; ++k) asm volatile(".rept 64\n " instruction "\n .endr" : "+r"(x) : "r"(y)); \
      const std::chrono::duration<double, std::nano> took = std::chrono::steady_clock::now() - begin;       \
      best = std::max(best, 64'000.0 * (cycles) / took.count());                                            \
    }                                                                                                       \
    return best;                                                                                            \
  }()

/// The clock that two chains agree on within a tenth, in GHz, else NaN. A single chain can lie: processors that add
/// constants while they rename registers take several such additions in a cycle, and their clock then reads 23.9 GHz.
inline double AgreedGHz(double by_additions, double by_multiplications) {
  const double most = std::max(by_additions, by_multiplications);
  const bool agree = std::abs(by_additions - by_multiplications) <= 0.1 * most;  // false for NaN
  return agree && most > 0.0 && std::isfinite(most) ? most : std::numeric_limits<double>::quiet_NaN();
}

/// The processor's clock in GHz, NaN where it cannot be told. Additions of two registers take one cycle, multiplications
/// three on x86-64 (Intel since Nehalem, AMD since Zen) and on many 64-bit Arm cores. On a core that differs the two
/// disagree: there is then no figure rather than a false one.
inline double ClockGHz() {
#ifdef __x86_64__
  return AgreedGHz(DYNOPROOF_CHAIN_GHZ("add %1, %0", 1), DYNOPROOF_CHAIN_GHZ("imul %1, %0", 3));
#elif defined(__aarch64__)
  return AgreedGHz(DYNOPROOF_CHAIN_GHZ("add %0, %0, %1", 1), DYNOPROOF_CHAIN_GHZ("mul %0, %0, %1", 3));
#else
  return std::numeric_limits<double>::quiet_NaN();
#endif
}
#undef DYNOPROOF_CHAIN_GHZ

/// Counter `GHz`, taken right after the loop that was timed: per_step * GHz are the cycles of a step. There is no counter
/// where the clock cannot be told.
inline void NoteClock(benchmark::State& state) {
  if (const double clock = ClockGHz(); std::isfinite(clock)) state.counters["GHz"] = clock;
}

}  // namespace dynoproof
