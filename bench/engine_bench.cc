// The hardware-in-the-loop engine in `realtime`, alone (pressure/hil_load_step) and with the chain of its test bed closed
// (pressure/hil_closed_chain): one iteration is one 100 us step, with controls and sampling, all crank angles in turn. The
// budgets are 20 us, and 10 us.
#include <benchmark/benchmark.h>

#include "bench/clock.h"
#include "experiment/prepare.h"
#include "sim/simulate.h"

namespace dynoproof {
namespace {

void EngineStep(benchmark::State& state, const std::string& scenario, std::vector<std::string> overrides) {
  Registry registry;
  RegisterBuiltIns(registry);
  Diagnostics diagnostics;
  overrides.insert(overrides.end(), {"check=[]", "variant={}"});
  const auto prepared = Prepare(DYNOPROOF_SCENARIOS "/pressure/" + scenario + ".toml",
                                {std::move(overrides), "realtime", nullptr}, registry, diagnostics);
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

BENCHMARK_CAPTURE(EngineStep, as_shipped, "hil_load_step", {});
BENCHMARK_CAPTURE(EngineStep, two_substeps, "hil_load_step", {"run.realtime.substeps=2"});
BENCHMARK_CAPTURE(EngineStep, closed_chain, "hil_closed_chain", {});

}  // namespace
}  // namespace dynoproof
