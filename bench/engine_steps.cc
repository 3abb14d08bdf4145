// A scenario alone for a number of steps, for instruction counts: engine_steps NAME STEPS; NAME: engine (the hardware-in-the-loop
// engine), chain (the same with the closed chain of its test bed), machine_loop (chapter 5 with the induction machine: line,
// machine, both controls).
#include <cstdio>
#include <cstdlib>
#include <map>
#include <string>

#include "experiment/prepare.h"
#include "sim/simulate.h"

int main(int argc, char** argv) {
  using namespace dynoproof;
  if (argc != 3) return 2;
  const std::map<std::string, std::string> scenarios = {{"engine", "/pressure/hil_load_step.toml"},
                                                        {"chain", "/pressure/hil_closed_chain.toml"},
                                                        {"machine_loop", "/suppression/adaptive_machine.toml"}};
  const auto scenario = scenarios.find(argv[1]);
  if (scenario == scenarios.end()) return 2;
  // The line is carried by vector instructions as wide as the processor has them: the count is that of the baseline.
  if (scenario->first == "machine_loop" && setenv("DYNOPROOF_CPU_CLASS", "x86-64", 1) != 0) return 2;
  Registry registry;
  RegisterBuiltIns(registry);
  Diagnostics diagnostics;
  const auto prepared = Prepare(DYNOPROOF_SCENARIOS + scenario->second,
                                {{"check=[]", "variant={}"}, "realtime", nullptr}, registry, diagnostics);
  if (prepared == nullptr) return 2;
  const auto solver = MakeRealtimeSolver(*prepared->rig);
  if (!solver.ok()) return 3;
  Simulation simulation(*prepared->rig, **solver);
  if (simulation.Start()) return 3;
  for (long n = std::atol(argv[2]); n > 0; --n) {
    if (simulation.Tick() || simulation.Integrate()) return 3;
  }
  std::printf("%.17g\n", simulation.OutputSample(0));
  return 0;
}
