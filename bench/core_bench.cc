// The 10 kHz core: a step of its parts, of the whole, with a machine and its torque control, and of the closed loop
// (70-mass rotor with all modes, actuator, core). Counter `simulated_per_s` is simulated seconds per second.
#include <benchmark/benchmark.h>

#include <cmath>
#include <cstdlib>
#include <limits>
#include <vector>

#include "base/random.h"
#include "base/subnormals.h"
#include "bench/clock.h"
#include "control10k/classical.h"
#include "control10k/core.h"
#include "control10k/torque_control.h"
#include "plugins/plant/induction_machine/induction_machine.h"
#include "thesis/suppression_loop.h"

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

/// Every how many steps one is done twice: real extra work, by which bench/ab.py --prove measures what it can find.
std::size_t ExtraWorkEvery() {
  const char* percent = std::getenv("DYNOPROOF_EXTRA_WORK_PERCENT");
  const int share = percent != nullptr ? std::atoi(percent) : 0;
  return share > 0 ? static_cast<std::size_t>(100 / share) : std::numeric_limits<std::size_t>::max();
}

void CoreStep(benchmark::State& state) {
  const FlushSubnormals flush;
  const std::vector<double> torque = Torque();
  const control10k::Core core(Config());
  control10k::CoreState memory;
  core.Start(memory);
  const std::size_t extra_every = ExtraWorkEvery();
  std::size_t n = 0, until_extra = extra_every;
  for (auto _ : state) {
    for (int twice = --until_extra == 0 ? 2 : 1; twice > 0; --twice) {
      benchmark::DoNotOptimize(core.Step(memory, {0.0, 0.01, torque[n], 9.7, state.range(0) != 0}));
    }
    if (until_extra == 0) until_extra = extra_every;
    n = n + 1 < torque.size() ? n + 1 : 0;
  }
  NoteClock(state);
}
BENCHMARK(CoreStep)->Arg(1)->Arg(0)->ArgName("adapt");

/// The plate of the backlash test bed's machines (Table C.1).
InductionMachine::Params Plate() {
  InductionMachine::Params plate;
  plate.rated_torque_Nm = 12.0;
  plate.rated_speed_rad_per_s = 171.2;
  plate.rated_voltage_V = 390.0;
  plate.rated_current_A = 4.8;
  return plate;
}

/// A machine over a period, Runge-Kutta 4 in one step as the realtime solver does.
void AdvanceMachine(const InductionMachine& machine, const double (&u_alpha_beta_speed)[3], double (&x)[4]) {
  constexpr double kPeriod = 1e-4, kShare[4] = {0.0, 0.5, 0.5, 1.0};
  double k[4][4], y[4];
  for (int stage = 0; stage < 4; ++stage) {
    for (int i = 0; i < 4; ++i) y[i] = x[i] + (stage == 0 ? 0.0 : kShare[stage] * kPeriod * k[stage - 1][i]);
    machine.InductionMachine::Derivative({0.0, u_alpha_beta_speed, y, {}}, k[stage]);
  }
  for (int i = 0; i < 4; ++i) x[i] += kPeriod / 6.0 * (k[0][i] + 2.0 * k[1][i] + 2.0 * k[2][i] + k[3][i]);
}

/// Torque control of a machine, and the machine; with `core` != 0 the core asks for the torque.
void TorqueControlAndMachine(benchmark::State& state) {
  const FlushSubnormals flush;
  std::vector<double> torque = Torque();
  for (double& one : torque) one *= 0.01;
  const control10k::Core core(Config());
  control10k::CoreState memory;
  core.Start(memory);
  const InductionMachine::Params plate = Plate();
  control10k::TorqueConfig config;
  plate.Derive(config.machine);
  const control10k::TorqueControl control(config);
  control10k::TorqueState flux;
  const InductionMachine machine(plate);
  double x[4] = {};
  machine.Start({}, x, {});
  std::size_t n = 0;
  double set = 0.0, made = 0.0;
  for (auto _ : state) {
    if (state.range(0) != 0) {
      core.Step(memory, {0.0, 0.01, torque[n], 9.7, true});
      set = memory.T_ref_Nm;
    } else {
      set = torque[n];
    }
    const auto out = control.Step(flux, {set, x[0], x[1], 10.0});
    AdvanceMachine(machine, {out.u_alpha_V, out.u_beta_V, 10.0}, x);
    made += out.torque_Nm;
    n = n + 1 < torque.size() ? n + 1 : 0;
  }
  benchmark::DoNotOptimize(made);
  NoteClock(state);
}
BENCHMARK(TorqueControlAndMachine)->Arg(0)->Arg(1)->ArgName("core");

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
  NoteClock(state);
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
  NoteClock(state);
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
