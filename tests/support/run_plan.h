// Runs a plan in a test: apply effects, build, simulate.
#pragma once

#include <gtest/gtest.h>

#include <memory>
#include <string>

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
