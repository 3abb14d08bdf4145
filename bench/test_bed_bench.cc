// The full backlash test bed in `realtime`: nine masses with play, two machines, their controllers. Counter `per_step`
// is the time of a 100 us period as `dynoproof run` spends it, sampling and recording included; `error` the NRMSE of
// omega_1 against `reference` up to the second impact. The budget of the issue is 1 us a step.
#include <benchmark/benchmark.h>

#include <cmath>

#include "bench/clock.h"
#include "experiment/prepare.h"
#include "sim/simulate.h"

namespace dynoproof {
namespace {

std::unique_ptr<Prepared> Load(const Registry& registry, std::vector<std::string> overrides, Diagnostics& diagnostics) {
  overrides.insert(overrides.end(), {"check=[]", "variant={}", "run.solver=realtime"});
  return Prepare(DYNOPROOF_SCENARIOS "/backlash/experiment_1.toml", {std::move(overrides), "", nullptr}, registry,
                 diagnostics);
}

double ErrorUpTo(const Samples& exact, const Samples& test, int output, double end_s) {
  double error = 0.0, mean = 0.0, square = 0.0, count = 0.0;
  for (std::size_t k = 0; k < exact.time.size(); ++k) {
    if (exact.time[k] < 0.1 || exact.time[k] > end_s) continue;
    const double a = exact.outputs[output][k], b = test.outputs[output][k];
    error += (a - b) * (a - b);
    mean += a;
    square += a * a;
    count += 1.0;
  }
  mean /= count;
  return std::sqrt(error / count / (square / count - mean * mean));
}

void TestBed(benchmark::State& state, std::vector<std::string> overrides) {
  Registry registry;
  RegisterBuiltIns(registry);
  Diagnostics diagnostics;
  const auto prepared = Load(registry, std::move(overrides), diagnostics);
  if (prepared == nullptr) return state.SkipWithError(diagnostics.Format().c_str());
  const Rig& rig = *prepared->rig;
  Result<Samples> samples = Failure{"no run"};
  const auto solver = MakeRealtimeSolver(rig);
  for (auto _ : state) {
    samples = Simulate(rig, **solver);
    if (!samples.ok()) return state.SkipWithError(samples.failure().ToString().c_str());
  }
  NoteClock(state);
  static const Result<Samples> exact = [&rig] {
    const auto reference = MakeReferenceSolver(rig);
    return Simulate(rig, **reference);
  }();
  // The second impact is at 152.4 ms.
  if (exact.ok()) state.counters["error"] = ErrorUpTo(*exact, *samples, FindOutput(rig, "omega_1"), 0.152);
  state.counters["per_step"] = benchmark::Counter(
      static_cast<double>(rig.steps), benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert);
}

BENCHMARK_CAPTURE(TestBed, as_shipped, {})->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(TestBed, one_correction, {"run.realtime.corrections=1"})->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(TestBed, two_substeps, {"run.realtime.substeps=2"})->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(TestBed, parts_in_every_sweep, {"run.realtime.part_corrections=0"})->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace dynoproof
