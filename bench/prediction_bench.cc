// The time of one simulation of a fit: the plan is built and run beside 14 000 rows of the soft rotor (70 masses), free and
// corrected. Counter `per_row`: time of a row. Building alone, and a single correction, are benchmarks of their own.
#include <benchmark/benchmark.h>

#include <memory>
#include <string>
#include <vector>

#include "base/random.h"
#include "bench/clock.h"
#include "estimation/built_run.h"
#include "estimation/predictor.h"
#include "experiment/checks.h"
#include "scenario/load.h"
#include "score/series.h"
#include "sim/simulate.h"

namespace dynoproof::estimation {
namespace {

constexpr double kRows = 14'000.0, kNoise = 0.01;

/// A scenario, its own run as a record with white noise, and the predictors of it.
struct Case {
  Registry registry;
  Plan plan;
  std::unique_ptr<DataSet> data;
  std::unique_ptr<LinearModel> model;
  std::unique_ptr<Predictor> free, corrected;
  std::string fault;

  explicit Case(const std::string& scenario) {
    RegisterBuiltIns(registry);
    RegisterChecks(registry);
    Diagnostics diagnostics;
    std::optional<Plan> loaded =
        LoadPlan(DYNOPROOF_SCENARIOS "/" + scenario + ".toml", {"run.duration_s=1.4"}, diagnostics);
    if (!loaded) {
      fault = diagnostics.Format();
      return;
    }
    plan = *std::move(loaded);
    MappedRecord made;  // of the scenario's own inputs
    made.end_s = plan.root.NumberOr("run.duration_s", 0.0);
    const Result<BuiltRun> run = BuildRun(plan, made, registry);
    if (!run.ok()) {
      fault = run.failure().ToString();
      return;
    }
    const Result<Samples> samples = Simulate(*run->rig, *run->solver);
    if (!samples.ok()) {
      fault = samples.failure().ToString();
      return;
    }
    MappedRecord record;
    const auto time = std::make_shared<const std::vector<double>>(samples->time);
    for (std::size_t i = 0; i < run->rig->inputs.size(); ++i)
      record.inputs[run->rig->inputs[i].name] = {time, std::make_shared<const std::vector<double>>(samples->inputs[i])};
    for (std::size_t j = 0; j < run->rig->outputs.size(); ++j) {
      std::vector<double> values = samples->outputs[j];
      const double sigma = kNoise * score::StandardDeviation(values);
      for (std::size_t i = 0; i < values.size(); ++i) values[i] += sigma * RandomNormal(1, j, i);
      record.outputs[run->rig->outputs[j].name] = {time,
                                                   std::make_shared<const std::vector<double>>(std::move(values))};
    }
    record.end_s = samples->time.back();
    for (auto* signals : {&record.inputs, &record.outputs}) {
      for (const auto& [name, series] : *signals) record.step_s[name] = run->rig->SecondsOf(run->rig->period);
    }
    data = std::make_unique<DataSet>(std::vector{record}, plan);
    const Result<LinearModel> linear = LinearModel::Of(plan, data->records().front(), registry);
    if (!linear.ok()) {
      fault = linear.failure().ToString();
      return;
    }
    model = std::make_unique<LinearModel>(*linear);
    const auto known = std::make_shared<mechanics::Decompositions>();
    free = std::make_unique<Predictor>(*data, *model, registry, std::nullopt, known);
    corrected = std::make_unique<Predictor>(*data, *model, registry, MemoryFor(*model, record.end_s), known);
  }
};

const Case& Of(const std::string& scenario) {
  static std::map<std::string, std::unique_ptr<Case>> cases;
  std::unique_ptr<Case>& own = cases[scenario];
  if (own == nullptr) own = std::make_unique<Case>(scenario);
  return *own;
}

void Predict(benchmark::State& state, const char* scenario, bool corrected) {
  const Case& of = Of(scenario);
  if (!of.fault.empty()) return state.SkipWithError(of.fault.c_str());
  const Predictor& predictor = corrected ? *of.corrected : *of.free;
  for (auto _ : state) {
    const Result<Eigen::VectorXd> innovations = predictor.Innovations(of.plan);
    if (!innovations.ok()) return state.SkipWithError(innovations.failure().ToString().c_str());
    benchmark::DoNotOptimize(innovations->data());
  }
  NoteClock(state);
  state.counters["per_row"] =
      benchmark::Counter(kRows, benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert);
}

/// The same plan again: its decomposition is known, as to all fits but those that move a mass or a stiffness.
void Build(benchmark::State& state, const char* scenario) {
  const Case& of = Of(scenario);
  if (!of.fault.empty()) return state.SkipWithError(of.fault.c_str());
  mechanics::Decompositions known;
  for (auto _ : state) {
    const Result<BuiltRun> run = BuildRun(of.plan, of.data->records().front(), of.registry, &known);
    if (!run.ok()) return state.SkipWithError(run.failure().ToString().c_str());
    benchmark::DoNotOptimize(run->rig.get());
  }
  NoteClock(state);
}

/// A correction by the errors of two outputs, as the run beside a record has one a tick.
void Correct(benchmark::State& state, const char* scenario) {
  const Case& of = Of(scenario);
  if (!of.fault.empty()) return state.SkipWithError(of.fault.c_str());
  const Result<BuiltRun> run = BuildRun(of.plan, of.data->records().front(), of.registry);
  if (!run.ok()) return state.SkipWithError(run.failure().ToString().c_str());
  const std::unique_ptr<Correction> correction =
      run->solver->MakeCorrection(of.corrected->observer()->GainsFor(*run->rig, {}), {});
  Simulation simulation(*run->rig, *run->solver);
  if (simulation.Start()) return state.SkipWithError("the run does not start");
  const std::vector<double> errors(of.corrected->outputs().size(), 1e-9);
  for (auto _ : state) {
    simulation.Correct(*correction, errors);
    benchmark::ClobberMemory();
  }
  NoteClock(state);
}

BENCHMARK_CAPTURE(Correct, soft_rotor, "diagnose/r2r_soft");
BENCHMARK_CAPTURE(Predict, soft_rotor_free, "diagnose/r2r_soft", false)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(Predict, soft_rotor_corrected, "diagnose/r2r_soft", true)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(Build, soft_rotor, "diagnose/r2r_soft")->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(Predict, heavy_duty_free, "diagnose/heavy_duty_lumped", false)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(Predict, heavy_duty_corrected, "diagnose/heavy_duty_lumped", true)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(Build, heavy_duty, "diagnose/heavy_duty_lumped")->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace dynoproof::estimation
