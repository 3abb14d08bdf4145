// What a nanosecond is worth here and now: clocks of shared machines differ and wander, cycles compare.
#pragma once

#include <benchmark/benchmark.h>

#include <algorithm>
#include <chrono>

namespace dynoproof {

/// The processor's clock in GHz, from 64 000 additions of which each waits for the one before (one cycle each on every
/// processor in question); the best of five tries.
inline double ClockGHz() {
  double best = 0.0;
  for (int i = 0; i < 5; ++i) {
    const auto begin = std::chrono::steady_clock::now();
    unsigned long x = 1;
    for (int k = 0; k < 1000; ++k) {
#ifdef __x86_64__
      asm volatile(".rept 64\n add $1, %0\n .endr" : "+r"(x));
#else
      asm volatile(".rept 64\n add %0, %0, #1\n .endr" : "+r"(x));
#endif
    }
    const std::chrono::duration<double, std::nano> took = std::chrono::steady_clock::now() - begin;
    best = std::max(best, 64'000.0 / took.count());
  }
  return best;
}

/// Counter `GHz`, taken right after the loop that was timed: per_step * GHz are the cycles of a step.
inline void NoteClock(benchmark::State& state) { state.counters["GHz"] = ClockGHz(); }

}  // namespace dynoproof
