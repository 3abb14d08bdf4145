// The hardware-in-the-loop engine alone for a number of steps, for instruction counts: engine_steps engine STEPS.
#include <cstdio>
#include <cstdlib>

#include "experiment/prepare.h"
#include "sim/simulate.h"

int main(int argc, char** argv) {
  using namespace dynoproof;
  if (argc != 3) return 2;
  Registry registry;
  RegisterBuiltIns(registry);
  Diagnostics diagnostics;
  const auto prepared = Prepare(DYNOPROOF_SCENARIOS "/pressure/hil_load_step.toml", {{"check=[]"}, "realtime", nullptr},
                                registry, diagnostics);
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
