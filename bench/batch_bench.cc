// Variants of the road-to-rig line in the lanes of a vector, against one after the other: cost of a step of one
// variant, by the number of modes kept. Both end with the same shaft torque, or the benchmark says so.
#include <benchmark/benchmark.h>

#include <cmath>
#include <memory>

#include "base/subnormals.h"
#include "experiment/prepare.h"
#include "linear/batch_propagator.h"
#include "linear/propagator.h"
#include "sim/linear_group.h"

namespace {

using namespace dynoproof;
using mechanics::BatchPropagator;
using mechanics::ModalForm;

constexpr int kLanes = BatchPropagator::kLanes, kSteps = 2000;

/// The modal forms of eight variants, decomposed once.
const std::vector<ModalForm>& Forms() {
  static const std::vector<ModalForm> forms = [] {
    Registry registry;
    RegisterBuiltIns(registry);
    std::vector<ModalForm> made;
    for (int i = 0; i < kLanes; ++i) {
      Diagnostics diagnostics;
      PrepareOptions options;
      options.overrides = {"plant.inertia.I5=" + std::to_string(0.075 + 0.002 * i), "check=[]"};
      const auto prepared = Prepare(DYNOPROOF_SCENARIOS "/r2r/soft_rotor_setup_1.toml", options, registry, diagnostics);
      made.push_back(ModalForm::Build(JoinLinearParts(*prepared->rig, AssignRoles(*prepared->rig)).system));
    }
    return made;
  }();
  return forms;
}

std::vector<ModalForm> Kept(int pairs) {
  std::vector<ModalForm> kept;
  for (const ModalForm& form : Forms()) kept.push_back(form.KeepPairs(pairs));
  return kept;
}

double Input(int step) { return std::sin(1e-5 * step * step); }

void OneByOne(benchmark::State& run) {
  const FlushSubnormals flush;
  const std::vector<ModalForm> forms = Kept(static_cast<int>(run.range(0)));
  std::vector<mechanics::Propagator> propagators;
  std::vector<mechanics::AlignedVector> states;
  for (const ModalForm& form : forms) {
    propagators.push_back(*mechanics::Propagator::Create(form, 1e-4));
    states.emplace_back(static_cast<std::size_t>(form.state_size()), 0.0);
  }
  std::vector<double> y(static_cast<std::size_t>(forms[0].outputs()));
  for (auto _ : run) {
    for (std::size_t i = 0; i < forms.size(); ++i) {
      for (int step = 0; step < kSteps; ++step) {
        const double u = 1e-3 * step;
        propagators[i].AdvanceAndOutput(states[i], {&u, 1}, y);
        benchmark::DoNotOptimize(y.data());
      }
    }
  }
  run.counters["ns/step"] = benchmark::Counter(static_cast<double>(run.iterations()) * kLanes * kSteps * 1e-9,
                                               benchmark::Counter::kIsRate | benchmark::Counter::kInvert);
}

void InLanes(benchmark::State& run) {
  const FlushSubnormals flush;
  const std::vector<ModalForm> forms = Kept(static_cast<int>(run.range(0)));
  std::vector<const ModalForm*> members;
  for (const ModalForm& form : forms) members.push_back(&form);
  std::vector<int> outputs;
  for (int i = 0; i < forms[0].outputs(); ++i) outputs.push_back(i);
  const auto batch = BatchPropagator::Create(members, 1e-4, outputs);
  if (!batch.ok()) return run.SkipWithError(batch.failure().message.c_str());
  mechanics::AlignedVector state(batch->state_size(), 0.0), y(outputs.size() * kLanes), u(kLanes), held(kLanes);
  // The answer first: the same as one by one.
  std::vector<double> alone(outputs.size());
  mechanics::AlignedVector single(static_cast<std::size_t>(forms[3].state_size()), 0.0);
  const auto propagator = mechanics::Propagator::Create(forms[3], 1e-4);
  double worst = 0.0, largest = 0.0;
  for (int step = 0; step < kSteps; ++step) {
    std::fill(u.begin(), u.end(), Input(step));
    batch->Step(state, held.data(), u.data(), y.data());
    propagator->Output(single, {&held[3], 1}, alone);
    for (std::size_t i = 0; i < alone.size(); ++i) {
      worst = std::max(worst, std::abs(alone[i] - y[i * kLanes + 3]));
      largest = std::max(largest, std::abs(alone[i]));
    }
    propagator->Advance(single, {&u[3], 1});
    held = u;
  }
  if (!(worst < 1e-12 * largest)) return run.SkipWithError("the lanes give another answer");
  for (auto _ : run) {
    for (int step = 0; step < kSteps; ++step) {
      std::fill(u.begin(), u.end(), 1e-3 * step);
      batch->Step(state, held.data(), u.data(), y.data());
      benchmark::DoNotOptimize(y.data());
    }
  }
  run.counters["ns/step"] = benchmark::Counter(static_cast<double>(run.iterations()) * kLanes * kSteps * 1e-9,
                                               benchmark::Counter::kIsRate | benchmark::Counter::kInvert);
}

BENCHMARK(OneByOne)->Arg(9)->Arg(18)->Arg(36)->Arg(71);
BENCHMARK(InLanes)->Arg(9)->Arg(18)->Arg(36)->Arg(71);

}  // namespace
