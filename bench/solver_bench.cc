// Whole solvers on r2r/soft_rotor_setup_1, as `dynoproof run` uses them: sampling, holding, recording included. Counter
// `per_step` is the time of a 100 us period, `error` the largest deviation of the shaft torque from the oracle
// held_input_exponential over its largest value. CVODE, restarted at every held input, is given 0.1 s of the chirp.
#include <benchmark/benchmark.h>

#include <algorithm>
#include <cmath>

#include "experiment/prepare.h"
#include "oracles/oracle.h"
#include "sim/simulate.h"

namespace dynoproof {
namespace {

void Run(benchmark::State& state, const char* solver_name, std::vector<std::string> overrides) {
  Registry registry;
  RegisterBuiltIns(registry);
  Diagnostics diagnostics;
  overrides.push_back("check=[]");
  const auto prepared = Prepare(DYNOPROOF_SCENARIOS "/r2r/soft_rotor_setup_1.toml", {overrides, solver_name, nullptr},
                                registry, diagnostics);
  if (prepared == nullptr) return state.SkipWithError(diagnostics.Format().c_str());
  const Rig& rig = *prepared->rig;
  Result<Samples> samples = Failure{"no run"};
  for (auto _ : state) {
    const auto solver = MakeSolver(solver_name, rig);
    samples = Simulate(rig, **solver);
    if (!samples.ok()) return state.SkipWithError(samples.failure().ToString().c_str());
  }
  const auto answer = oracles::HeldInputExponential(
      {prepared->plan.root, samples->time, {{"T_airgap", samples->inputs[0]}}, {"T_shaft"}});
  if (!answer.ok()) return state.SkipWithError(answer.failure().ToString().c_str());
  const std::vector<double>& exact = answer->at("T_shaft");
  double error = 0.0, peak = 0.0;
  for (std::size_t k = 0; k < exact.size(); ++k) {
    error = std::max(error, std::abs(samples->outputs[0][k] - exact[k]));
    peak = std::max(peak, std::abs(exact[k]));
  }
  state.counters["error"] = error / peak;
  state.counters["per_step"] = benchmark::Counter(
      static_cast<double>(rig.steps), benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert);
}

BENCHMARK_CAPTURE(Run, realtime, "realtime", {})->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(Run, realtime_below_2_5_kHz, "realtime", {"run.realtime.keep_below_Hz=2500.0"})
    ->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(Run, reference_arkode, "reference", {})->Unit(benchmark::kMillisecond)->Iterations(1);
BENCHMARK_CAPTURE(Run, reference_cvode_bdf, "reference",
                  {"run.reference.method=bdf", "run.reference.relative_tolerance=1e-6", "run.duration_s=0.1"})
    ->Unit(benchmark::kMillisecond)
    ->Iterations(1);

}  // namespace
}  // namespace dynoproof
