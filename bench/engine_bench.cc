// Whole scenarios in `realtime`: one iteration is one 100 us step, with controls and sampling. The hardware-in-the-loop engine
// alone (pressure/hil_load_step) and with the chain of its test bed closed (pressure/hil_closed_chain), all crank angles in turn:
// the budgets are 20 us, and 10 us. And suppression/adaptive_machine: line, machine, both controls.
#include <benchmark/benchmark.h>

#include "bench/clock.h"
#include "experiment/prepare.h"
#include "sim/simulate.h"

namespace dynoproof {
namespace {

/// The scenario's steps from number 2000 on.
void Step(benchmark::State& state, const std::string& scenario, std::vector<std::string> overrides) {
  Registry registry;
  RegisterBuiltIns(registry);
  Diagnostics diagnostics;
  overrides.insert(overrides.end(), {"check=[]", "variant={}"});
  const auto prepared =
      Prepare(DYNOPROOF_SCENARIOS + scenario, {std::move(overrides), "realtime", nullptr}, registry, diagnostics);
  if (prepared == nullptr) return state.SkipWithError(diagnostics.Format().c_str());
  const auto solver = MakeRealtimeSolver(*prepared->rig);
  if (!solver.ok()) return state.SkipWithError(solver.failure().ToString().c_str());
  Simulation simulation(*prepared->rig, **solver);
  Status failed = simulation.Start();
  for (int i = 0; i < 2000 && !failed; ++i) {  // all cylinders have fired
    failed = simulation.Tick();
    if (!failed) failed = simulation.Integrate();
  }
  for (auto _ : state) {
    failed = simulation.Tick();
    if (!failed) failed = simulation.Integrate();
    if (failed) return state.SkipWithError(failed->ToString().c_str());
  }
  NoteClock(state);
}

void EngineStep(benchmark::State& state, const std::string& scenario, std::vector<std::string> overrides) {
  Step(state, "/pressure/" + scenario + ".toml", std::move(overrides));
}
void MachineLoopStep(benchmark::State& state) { Step(state, "/suppression/adaptive_machine.toml", {}); }

BENCHMARK_CAPTURE(EngineStep, as_shipped, "hil_load_step", {});
BENCHMARK_CAPTURE(EngineStep, two_substeps, "hil_load_step", {"run.realtime.substeps=2"});
BENCHMARK_CAPTURE(EngineStep, closed_chain, "hil_closed_chain", {});
BENCHMARK(MachineLoopStep);

}  // namespace
}  // namespace dynoproof
