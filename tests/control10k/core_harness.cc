// A harness as a control engineer would write it: the core's headers and the standard library, nothing else. Its build
// compiles the core's sources once more, with other flags than the engine's.
//
// stdin: the configuration (k_P, k_I, T_limit), then rows of six doubles (omega_ref, omega, T_shaft, k_V, adapt,
// unused). stdout: T_ref of each row.
#include <cstdio>

#include "control10k/core.h"

int main() {
  double head[3];
  if (std::fread(head, sizeof head, 1, stdin) != 1) return 2;
  control10k::CoreConfig config;
  config.speed = {head[0], head[1], head[2]};
  if (!control10k::IsUsable(config)) return 2;
  const control10k::Core core(config);
  control10k::CoreState state;
  core.Start(state);
  double row[6];
  while (std::fread(row, sizeof row, 1, stdin) == 1) {
    const double T_ref = core.Step(state, {row[0], row[1], row[2], row[3], row[4] > 0.5});
    std::fwrite(&T_ref, sizeof T_ref, 1, stdout);
  }
  return 0;
}
