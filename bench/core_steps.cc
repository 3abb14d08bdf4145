// The core alone for a given number of steps, for instruction counts: two runs of different length under callgrind
// differ by the steps between them and nothing else. core_steps NAME STEPS; NAME: core (adaptive), filter (adaptation
// off), torque (torque control of a machine whose currents run through a table).
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>

#include "control10k/core.h"
#include "control10k/torque_control.h"

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
  if (std::strcmp(argv[1], "torque") == 0) {
    // A small machine; the count does not depend on its numbers.
    const control10k::TorqueControl control({.machine = {.R_s = 3.9,
                                                         .R_R = 2.6,
                                                         .L_M = 0.236,
                                                         .L_sigma = 0.03,
                                                         .pole_pairs = 2.0,
                                                         .rated_flux = 0.73,
                                                         .rated_i_d = 3.1,
                                                         .rated_i_q = 6.04,
                                                         .rated_peak_current = 6.79}});
    control10k::TorqueState flux;
    for (long n = 0; n < steps; ++n) {
      sum += control.Step(flux, {0.1 * torque[n % 1280], 3.0, 0.01 * torque[n % 1280], 10.0}).u_alpha_V;
    }
    std::printf("%.17g\n", sum);
    return 0;
  }
  for (long n = 0; n < steps; ++n) sum += core.Step(state, {0.0, 0.01, torque[n % 1280], 9.7, adapt});
  std::printf("%.17g\n", sum);
  return 0;
}
