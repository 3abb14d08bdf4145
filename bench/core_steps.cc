// The core alone for a given number of steps, for instruction counts: two runs of different length under callgrind
// differ by the steps between them and nothing else. core_steps NAME STEPS; NAME: core (adaptive), filter (adaptation
// off).
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>

#include "control10k/core.h"

int main(int argc, char** argv) {
  if (argc != 3) return 2;
  const bool adapt = std::strcmp(argv[1], "core") == 0;
  const long steps = std::atol(argv[2]);
  control10k::CoreConfig config;
  config.speed = {20.0, 20.0, 4000.0};
  const control10k::Core core(config);
  control10k::CoreState state;
  core.Start(state);
  // Signals of a table, so that the loop around the step costs nothing that changes: two tones that are found, and
  // noise.
  static double torque[1280];
  unsigned random = 1;
  for (int n = 0; n < 1280; ++n) {
    random = random * 1664525u + 1013904223u;
    torque[n] = 100.0 * std::sin(0.5228 * n) + 30.0 * std::sin(0.3808 * n) + 1e-9 * random;
  }
  double sum = 0.0;
  for (long n = 0; n < steps; ++n) sum += core.Step(state, {0.0, 0.01, torque[n % 1280], 9.7, adapt});
  std::printf("%.17g\n", sum);
  return 0;
}
