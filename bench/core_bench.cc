// The 10 kHz core: a step of its parts, of the whole, and of the closed loop (70-mass rotor with all modes, actuator,
// core). Counter `simulated_per_s` is simulated seconds per second.
#include <benchmark/benchmark.h>

#include <cmath>
#include <vector>

#include "base/random.h"
#include "base/subnormals.h"
#include "control10k/classical.h"
#include "control10k/core.h"
#include "experiment/suppression_loop.h"

namespace dynoproof {
namespace {

std::vector<double> Torque() {
  std::vector<double> torque(1280);
  for (int n = 0; n < 1280; ++n) torque[n] = 100.0 * std::sin(0.5228 * n) + RandomNormal(1, 0, n);
  return torque;
}

control10k::CoreConfig Config() {
  control10k::CoreConfig config;
  config.speed = {20.0, 20.0, 4000.0};
  return config;
}

void CoreStep(benchmark::State& state) {
  const FlushSubnormals flush;
  const std::vector<double> torque = Torque();
  const control10k::Core core(Config());
  control10k::CoreState memory;
  core.Start(memory);
  std::size_t n = 0;
  for (auto _ : state) {
    benchmark::DoNotOptimize(core.Step(memory, {0.0, 0.01, torque[n], 9.7, state.range(0) != 0}));
    n = n + 1 < torque.size() ? n + 1 : 0;
  }
}
BENCHMARK(CoreStep)->Arg(1)->Arg(0)->ArgName("adapt");

void GoertzelBank(benchmark::State& state) {
  const std::vector<double> torque = Torque();
  control10k::GoertzelTables tables;
  control10k::MakeTables(128, 24, tables);
  control10k::Goertzel bank;
  std::size_t n = 0;
  for (auto _ : state) {
    if (bank.Step(tables, torque[n])) bank.Reset();
    n = n + 1 < torque.size() ? n + 1 : 0;
  }
  benchmark::DoNotOptimize(bank);
}
BENCHMARK(GoertzelBank);

void TwoNotches(benchmark::State& state) {
  const std::vector<double> torque = Torque();
  control10k::Notch a, b;
  control10k::DesignNotch(0.5228, 0.995, a.c);
  control10k::DesignNotch(0.3808, 0.995, b.c);
  std::size_t n = 0;
  for (auto _ : state) {
    benchmark::DoNotOptimize(b.Step(a.Step(torque[n])));
    n = n + 1 < torque.size() ? n + 1 : 0;
  }
}
BENCHMARK(TwoNotches);

void ClassicalStep(benchmark::State& state) {
  const std::vector<double> torque = Torque();
  control10k::ClassicalConfig config;
  config.law = static_cast<control10k::ClassicalLaw>(state.range(0));
  const control10k::Classical filter(config);
  control10k::ClassicalState memory;
  filter.Start(memory);
  std::size_t n = 0;
  for (auto _ : state) {
    benchmark::DoNotOptimize(filter.Step(memory, torque[n], true));
    n = n + 1 < torque.size() ? n + 1 : 0;
  }
}
BENCHMARK(ClassicalStep)->DenseRange(0, 4)->ArgName("law");

void ClosedLoop(benchmark::State& state) {
  const FlushSubnormals flush;
  auto loop = SuppressionLoop::Create(R2RPlant(), Config());
  if (!loop.ok()) return state.SkipWithError(loop.failure().ToString().c_str());
  const std::vector<double> torque = Torque();
  std::size_t n = 0;
  for (auto _ : state) {
    loop->Step(0.0, 0.01 * torque[n], 9.7, true);
    n = n + 1 < torque.size() ? n + 1 : 0;
  }
  benchmark::DoNotOptimize(loop->T_ref_Nm());
  // The answer, too: both filters stand where they should.
  if (state.iterations() > 50'000) {
    const auto& placed = loop->core_state().suppression;
    if (std::abs(placed.f_Hz[0] - 832.0) > 3.0 || std::abs(placed.f_Hz[1] - 606.0) > 3.0) {
      return state.SkipWithError("the loop's filters are not where they should be");
    }
  }
  state.counters["simulated_per_s"] =
      benchmark::Counter(1e-4 * static_cast<double>(state.iterations()), benchmark::Counter::kIsRate);
}
BENCHMARK(ClosedLoop);

}  // namespace
}  // namespace dynoproof
