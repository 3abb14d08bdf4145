// A harness as a control engineer would write it: the core's headers and the standard library, nothing else. Its build
// compiles the core's sources once more, with other flags than the engine's.
//
// core_harness: stdin holds the configuration (k_P, k_I, T_limit), then rows of six doubles (omega_ref, omega, T_shaft,
// k_V, adapt, unused); stdout T_ref of each row.
// core_harness torque: stdin holds R_s, R_R, L_M, L_sigma, pole pairs, rated flux, i_d, i_q, peak current, initial
// torque, then rows of four (set point, i_alpha, i_beta, speed); stdout u_alpha of each row.
#include <cstdio>

#include "control10k/core.h"
#include "control10k/torque_control.h"

namespace {

int RunTorqueControl() {
  double head[10];
  if (std::fread(head, sizeof head, 1, stdin) != 1) return 2;
  control10k::TorqueConfig config;
  config.machine = {head[0], head[1], head[2], head[3], head[4], head[5], head[6], head[7], head[8]};
  config.initial_torque_Nm = head[9];
  if (!control10k::IsUsable(config)) return 2;
  const control10k::TorqueControl control(config);
  control10k::TorqueState state;
  double row[4];
  while (std::fread(row, sizeof row, 1, stdin) == 1) {
    const double u_alpha = control.Step(state, {row[0], row[1], row[2], row[3]}).u_alpha_V;
    std::fwrite(&u_alpha, sizeof u_alpha, 1, stdout);
  }
  return 0;
}

}  // namespace

int main(int argc, char**) {
  if (argc > 1) return RunTorqueControl();
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
