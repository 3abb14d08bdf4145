// One step of the R2R soft rotor (72 inertias, thesis Table A.7): this propagator beside its peers, in one run.
//
// A chirp of airgap torque, 0 - 2000 Hz in 10 s, held at 10 kHz (100 000 steps). Each method first answers: counter
// `error` is its largest deviation in the shaft torque, relative to the largest torque, from the matrix exponential of
// the equations of motion in extended precision. Then it is timed from the same state: counter `per_step`.
#include <benchmark/benchmark.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <vector>
#ifdef DYNOPROOF_HAVE_BOOST
#include <boost/numeric/odeint/stepper/runge_kutta4.hpp>
#endif

#include "base/subnormals.h"
#include "bench/clock.h"
#include "linear/aligned_vector.h"
#include "linear/energy_coordinates.h"
#include "linear/propagator.h"
#include "tests/support/held_reference.h"
#include "tests/support/plants.h"

namespace dynoproof::mechanics {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr int kSteps = 100'000;
constexpr double kStep = 1e-4;

struct Task {
  Network network = support::SoftRotorR2R();
  MatrixXd airgap = support::AirgapR2R();
  int shaft = network.FindEdge("k4");
  LinearSystem system;
  ModalForm form;
  std::vector<double> torque, expected;  // input, and shaft torque at the end of each step
  double peak = 0.0;

  Task() : torque(kSteps), expected(kSteps) {
    const auto coordinates = EnergyCoordinates::Build(network, airgap);
    system = coordinates->System({coordinates->EdgeTorque(shaft)});
    form = ModalForm::Build(system);
    const support::ReferenceSystem reference(network, airgap);
    const support::HeldReference exact(reference.A, reference.B, kStep);
    const support::VectorXld row = reference.C.row(shaft), force = exact.held.col(0);
    support::VectorXld state = support::VectorXld::Zero(reference.A.rows()), next = state;
    for (int k = 0; k < kSteps; ++k) {
      const double t = k * kStep;
      torque[k] = std::sin(2.0 * std::numbers::pi * 100.0 * t * t);
      next.noalias() = exact.phi * state;
      state = next + force * static_cast<long double>(torque[k]);
      expected[k] = static_cast<double>(row.dot(state));
      peak = std::max(peak, std::abs(expected[k]));
    }
  }
};

const Task& TheTask() {
  static const Task task;
  return task;
}

/// Runs `simulate(torque, output)`, which starts from rest, once for the error and then for the time.
template <class Simulate>
void Measure(benchmark::State& state, const Simulate& simulate) {
  const Task& task = TheTask();
  const FlushSubnormals flush;
  std::vector<double> output(kSteps, std::numeric_limits<double>::quiet_NaN());
  simulate(task.torque, output);
  double error = 0.0;
  for (int k = 0; k < kSteps; ++k) {
    const double deviation = std::abs(output[k] - task.expected[k]) / task.peak;
    if (!(deviation <= error)) error = deviation;  // keeps a NaN
    if (std::isnan(error)) break;
  }
  for (auto _ : state) {
    simulate(task.torque, output);
    benchmark::ClobberMemory();
  }
  NoteClock(state);
  state.counters["error"] = error;
  state.counters["per_step"] =
      benchmark::Counter(kSteps, benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert);
}

/// range(0): pairs kept; range(1): class of vector instructions.
void Modal(benchmark::State& state) {
  const auto cpu_class = static_cast<CpuClass>(state.range(1));
  const auto propagator =
      Propagator::Create(TheTask().form.KeepPairs(static_cast<int>(state.range(0))), kStep, cpu_class);
  if (!propagator.ok()) return state.SkipWithError(propagator.failure().message.c_str());
  state.SetLabel(std::string(ToString(cpu_class)));
  AlignedVector rotor(propagator->state_size());
  const Propagator& step = *propagator;
  Measure(state, [&](const std::vector<double>& torque, std::vector<double>& output) {
    std::fill(rotor.begin(), rotor.end(), 0.0);
    for (int k = 0; k < kSteps; ++k) step.AdvanceAndOutput(rotor, {&torque[k], 1}, {&output[k], 1});
  });
}
BENCHMARK(Modal)
    ->ArgNames({"pairs", "class"})
    ->ArgsProduct({{71, 9, 10, 16}, {2, 1, 0}})
    ->Unit(benchmark::kMillisecond);

/// The same exact step with a dense transition matrix, by Eigen (vector instructions of the build, SSE2 by default).
void EigenDense(benchmark::State& state) {
  const Task& task = TheTask();
  const support::ReferenceSystem reference(task.system);
  const support::HeldReference exact(reference.A, reference.B, kStep);
  const int n = task.system.states();
  const MatrixXd phi = exact.phi.topLeftCorner(n, n).cast<double>();
  const VectorXd force = exact.held.col(0).head(n).cast<double>(), row = task.system.C.row(0);
  VectorXd x(n), next(n);
  Measure(state, [&](const std::vector<double>& torque, std::vector<double>& output) {
    x.setZero();
    for (int k = 0; k < kSteps; ++k) {
      next = force * torque[k];
      next.noalias() += phi * x;
      x.swap(next);
      output[k] = row.dot(x);
    }
  });
}
BENCHMARK(EigenDense)->Unit(benchmark::kMillisecond);

#ifdef DYNOPROOF_HAVE_BOOST
/// Boost.Odeint, classical Runge-Kutta with 8 substeps: below 7 it is unstable on this rotor.
void OdeintRk4(benchmark::State& state) {
  constexpr int kNodes = 72, kSubsteps = 8;
  using Motion = std::array<double, 2 * kNodes>;  // angles, speeds
  const Task& task = TheTask();
  std::array<double, kNodes> inverse_inertia, weight;
  std::array<double, kNodes - 1> k, c;  // the edges of this chain join neighbours
  for (int i = 0; i < kNodes; ++i) inverse_inertia[i] = 1.0 / task.network.nodes[i].inertia;
  for (int i = 0; i < kNodes; ++i) weight[i] = task.airgap(i, 0);
  for (int i = 0; i + 1 < kNodes; ++i) k[i] = task.network.edges[i].stiffness;
  for (int i = 0; i + 1 < kNodes; ++i) c[i] = task.network.edges[i].damping;
  double airgap = 0.0;
  const auto motion = [&](const Motion& s, Motion& rate, double) {
    double left = 0.0;
    for (int i = 0; i < kNodes; ++i) {
      const double right = i + 1 < kNodes ? k[i] * (s[i] - s[i + 1]) + c[i] * (s[kNodes + i] - s[kNodes + i + 1]) : 0.0;
      rate[i] = s[kNodes + i];
      rate[kNodes + i] = (weight[i] * airgap + left - right) * inverse_inertia[i];
      left = right;
    }
  };
  boost::numeric::odeint::runge_kutta4<Motion> stepper;
  Measure(state, [&](const std::vector<double>& torque, std::vector<double>& output) {
    Motion s{};
    for (int step = 0; step < kSteps; ++step) {
      airgap = torque[step];
      for (int i = 0; i < kSubsteps; ++i) stepper.do_step(motion, s, 0.0, kStep / kSubsteps);
      output[step] = k[70] * (s[70] - s[71]) + c[70] * (s[kNodes + 70] - s[kNodes + 71]);
    }
  });
}
BENCHMARK(OdeintRk4)->Unit(benchmark::kMillisecond);
#endif

/// Not a step: what it costs to prepare the plant.
void Decompose(benchmark::State& state) {
  for (auto _ : state) benchmark::DoNotOptimize(ModalForm::Build(TheTask().system));
}
BENCHMARK(Decompose)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace dynoproof::mechanics
