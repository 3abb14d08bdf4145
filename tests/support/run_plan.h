// Runs a plan in a test: apply effects, build, simulate.
#pragma once

#include <gtest/gtest.h>

#include <map>
#include <memory>
#include <string>
#include <vector>

#include "model/registry.h"
#include "sim/simulate.h"
#include "tests/support/build.h"

namespace dynoproof::testing {

/// The rig of a plan; a test failure with all diagnostics when it cannot be built.
inline std::unique_ptr<Rig> RigOf(Plan plan, const Records& records = {}) {
  Diagnostics diagnostics;
  ApplyEffects(BuiltIns(), plan, diagnostics);
  std::unique_ptr<Rig> rig = Rig::Build(plan, BuiltIns(), records, diagnostics);
  EXPECT_FALSE(diagnostics.has_errors()) << diagnostics.Format();
  return rig;
}

/// Simulates with the solver of that name.
inline Samples RunRig(const Rig& rig, const std::string& solver) {
  Result<std::unique_ptr<Solver>> made = MakeSolver(solver, rig);
  if (!made.ok()) {
    ADD_FAILURE() << made.failure().ToString();
    return {};
  }
  Result<Samples> samples = Simulate(rig, **made);
  if (!samples.ok()) {
    ADD_FAILURE() << samples.failure().ToString();
    return {};
  }
  return std::move(*samples);
}

inline Samples RunPlan(const Plan& plan, const std::string& solver) {
  const std::unique_ptr<Rig> rig = RigOf(plan);
  return rig == nullptr ? Samples{} : RunRig(*rig, solver);
}

/// A run with what its outputs do not tell: the states of the rig at each tick, by name.
struct StateCourses {
  std::map<std::string, std::vector<double>> states;
  std::vector<std::vector<double>> outputs;
};
inline StateCourses RunWithStates(const Plan& plan, const std::string& name) {
  StateCourses courses;
  const std::unique_ptr<Rig> rig = RigOf(plan);
  if (rig == nullptr) return courses;
  Result<std::unique_ptr<Solver>> solver = MakeSolver(name, *rig);
  if (!solver.ok()) {
    ADD_FAILURE() << solver.failure().ToString();
    return courses;
  }
  Simulation run(*rig, **solver);
  courses.outputs.resize(rig->outputs.size());
  Status failed = run.Start();
  for (std::int64_t step = 0; !failed && step <= rig->steps; ++step) {
    failed = run.Tick();
    for (std::size_t i = 0; i < courses.outputs.size(); ++i) courses.outputs[i].push_back(run.OutputSample(i));
    const std::vector<double> states = (*solver)->States(run.frame());
    for (std::size_t i = 0; i < states.size(); ++i) courses.states[rig->state_ports[i].name].push_back(states[i]);
    if (!failed && step < rig->steps) failed = run.Integrate();
  }
  if (failed) ADD_FAILURE() << failed->ToString();
  return courses;
}

/// RMS of the difference over the standard deviation of the reference.
inline double Nrmse(const std::vector<double>& reference, const std::vector<double>& test) {
  if (reference.size() != test.size() || reference.empty()) return INFINITY;
  double mean = 0.0, error = 0.0, spread = 0.0;
  for (const double value : reference) mean += value / static_cast<double>(reference.size());
  for (std::size_t i = 0; i < reference.size(); ++i) {
    error += (test[i] - reference[i]) * (test[i] - reference[i]);
    spread += (reference[i] - mean) * (reference[i] - mean);
  }
  return std::sqrt(error / spread);
}

/// One inertia that a torque drives, its speed recorded: the simplest rig there is. `source` drives it.
inline Plan OneMass(double inertia, Value source, double duration_s = 0.1) {
  return {"one_mass", "one_mass.toml",
          Value{{"run", Value{{"duration_s", duration_s}}},
                {"plant", Value{{"type", "drive_line"},
                                {"nominal_torque_Nm", 1.0},
                                {"inertia", Value{{"I", inertia}}},
                                {"torque", Value{{"T", Value{{"on", "I"}}}}}}},
                {"input", Value{{"T", Value{{"to", "plant.T"}, {"source", std::move(source)}}}}},
                {"output", Value{{"w", Value{{"of", "plant.I.speed"}}}, {"phi", Value{{"of", "plant.I.angle"}}}}}}};
}

}  // namespace dynoproof::testing
