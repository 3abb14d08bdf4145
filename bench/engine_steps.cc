// The hardware-in-the-loop engine alone, or with the closed chain of its test bed, for a number of steps, for instruction
// counts: engine_steps engine|chain STEPS.
#include <cstdio>
#include <cstdlib>
#include <string_view>

#include "experiment/prepare.h"
#include "sim/simulate.h"

int main(int argc, char** argv) {
  using namespace dynoproof;
  if (argc != 3) return 2;
  const bool chain = std::string_view(argv[1]) == "chain";
  const char* file = chain ? DYNOPROOF_SCENARIOS "/pressure/hil_closed_chain.toml"
                           : DYNOPROOF_SCENARIOS "/pressure/hil_load_step.toml";
  Registry registry;
  RegisterBuiltIns(registry);
  Diagnostics diagnostics;
  const auto prepared = Prepare(file, {{"check=[]", "variant={}"}, "realtime", nullptr}, registry, diagnostics);
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
