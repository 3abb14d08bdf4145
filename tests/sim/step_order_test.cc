// The steps of simulate.h, each by a case whose answer is known in closed form.
#include <cmath>

#include "tests/support/run_plan.h"

namespace dynoproof::testing {
namespace {

const char* const kSolvers[] = {"realtime", "reference"};

/// A held ramp sampled at 0.1 ms: w(t_k) = sum of the commands before k times the period over the inertia.
TEST(StepOrder, CommandOfATickActsFromThatTickOn) {
  const Plan plan = OneMass(2.0, Value{{"type", "ramp"}, {"to", 10.0}, {"duration_s", 0.01}}, 0.02);
  for (const char* solver : kSolvers) {
    const Samples samples = RunPlan(plan, solver);
    ASSERT_EQ(samples.time.size(), 201u);
    double speed = 0.0;
    for (std::size_t k = 0; k < samples.time.size(); ++k) {
      // Round-off of 200 additions of values up to 10.
      EXPECT_NEAR(samples.outputs[0][k], speed, 1e-12) << solver << " row " << k;
      speed += samples.inputs[0][k] * 1e-4 / 2.0;
    }
  }
}

TEST(StepOrder, RowHoldsTheCommandFromItsTimeOn) {
  const Plan plan = OneMass(1.0, Value{{"type", "step"}, {"value", 3.0}, {"time_s", 0.005}}, 0.01);
  for (const char* solver : kSolvers) {
    const Samples samples = RunPlan(plan, solver);
    EXPECT_EQ(samples.inputs[0][49], 0.0);
    EXPECT_EQ(samples.inputs[0][50], 3.0);
    EXPECT_EQ(samples.outputs[0][50], 0.0) << "the step has not acted yet at its own tick";
    EXPECT_NEAR(samples.outputs[0][51], 3e-4, 1e-15);
  }
}

Plan Delayed(const char* chain, double delay_s) {
  Plan plan = OneMass(1.0, Value{{"type", "step"}, {"value", 1.0}, {"time_s", 0.001}}, 0.01);
  const Value stage = Value{{"type", "delay"}, {"delay_s", delay_s}};
  if (std::string(chain) == "actuator") {
    plan.root["input"]["T"]["actuator"] = Value(Value::Array{stage});
  } else {
    plan.root["output"]["w"]["sensor"] = Value(Value::Array{stage});
  }
  return plan;
}

/// A delay need not be a multiple of the period: w(t) = max(0, t - 1 ms - delay) for a unit torque on a unit inertia.
TEST(StepOrder, DelaysOfAnyLengthAreExact) {
  for (const char* chain : {"actuator", "sensor"}) {
    for (const double delay_s : {0.0, 1e-4, 3e-4, 0.37e-4, 2.5e-4, 1.234567e-3}) {
      for (const char* solver : kSolvers) {
        const Samples samples = RunPlan(Delayed(chain, delay_s), solver);
        for (std::size_t k = 0; k < samples.time.size(); ++k) {
          EXPECT_NEAR(samples.outputs[0][k], std::max(0.0, samples.time[k] - 0.001 - delay_s), 1e-13)
              << chain << " " << delay_s << " " << solver << " row " << k;
        }
      }
    }
  }
}

/// A command jumps at a tick, and a sample of that tick shows what was before. So does one that comes whole periods late.
TEST(StepOrder, WholePeriodsOfDelayShiftTheSamplesOfAHeldSignal) {
  const auto samples_of = [](int periods, const char* solver) {
    Plan plan = OneMass(1.0, Value{{"type", "ramp"}, {"to", 1.0}, {"duration_s", 0.01}}, 0.01);
    plan.root["output"]["w"]["of"] = "input.T";
    if (periods > 0)
      plan.root["output"]["w"]["sensor"] = Value(Value::Array{Value{{"type", "delay"}, {"delay_s", periods * 1e-4}}});
    return RunPlan(plan, solver).outputs[0];
  };
  for (const char* solver : kSolvers) {
    const std::vector<double> at_once = samples_of(0, solver);
    ASSERT_GT(at_once.size(), 100u);
    EXPECT_NE(at_once[50], at_once[51]);
    for (const int periods : {1, 3, 12}) {
      const std::vector<double> late = samples_of(periods, solver);
      ASSERT_EQ(late.size(), at_once.size());
      for (std::size_t k = static_cast<std::size_t>(periods); k < late.size(); ++k)
        EXPECT_EQ(late[k], at_once[k - static_cast<std::size_t>(periods)]) << solver << " " << periods << " row " << k;
    }
  }
}

/// Before the run a controller gave what it gives first: a constant torque behind a delay acts from the start.
TEST(StepOrder, ADelayBehindAControllerBeginsWithItsFirstCommand) {
  for (const double delay_s : {0.37e-4, 1e-4, 2.5e-4, 1.234567e-3}) {
    Plan plan = OneMass(1.0, Value{{"type", "constant"}, {"value", 0.0}}, 0.005);
    plan.root["control"] = Value{{"hold", Value{{"type", "speed_pi"},
                                                {"k_P_Nms_per_rad", 0.0},
                                                {"k_I_Nm_per_rad", 0.0},
                                                {"limit_Nm", 10.0},
                                                {"initial_torque_Nm", 2.0},
                                                {"inputs", Value{{"reference", "output.w"}, {"speed", "output.w"}}}}}};
    plan.root["input"]["T"] = Value{{"to", "plant.T"},
                                    {"from", "control.hold.torque"},
                                    {"actuator", Value(Value::Array{Value{{"type", "delay"}, {"delay_s", delay_s}}})}};
    for (const char* solver : kSolvers) {
      const Samples samples = RunPlan(plan, solver);
      for (std::size_t k = 0; k < samples.time.size(); ++k) {
        EXPECT_NEAR(samples.outputs[0][k], 2.0 * samples.time[k], 1e-13) << delay_s << " " << solver << " row " << k;
      }
    }
  }
}

/// First-order lag (2.4) before a unit inertia: w = t - tau (1 - exp(-t/tau)) behind a step.
TEST(StepOrder, ActuatorLagActsInContinuousTime) {
  // A lag starts in the steady state of the first command, so the step comes one tick later.
  Plan plan = OneMass(1.0, Value{{"type", "step"}, {"value", 1.0}, {"time_s", 1e-4}}, 0.01);
  plan.root["input"]["T"]["actuator"] = Value(Value::Array{Value{{"type", "first_order_lag"}, {"tau_s", 1.3e-3}}});
  plan.root["run"]["reference"] = Value{{"relative_tolerance", 1e-12}};
  // `reference` integrates with 1e-12 a step; `realtime` is exact.
  for (const auto& [solver, tolerance] : {std::pair("realtime", 1e-15), std::pair("reference", 1e-12)}) {
    const Samples samples = RunPlan(plan, solver);
    for (std::size_t k = 0; k < samples.time.size(); ++k) {
      const double t = std::max(0.0, samples.time[k] - 1e-4);
      EXPECT_NEAR(samples.outputs[0][k], t + 1.3e-3 * std::expm1(-t / 1.3e-3), tolerance) << solver;
    }
  }
}

TEST(Solvers, OfAnUnknownNameAreRefused) {
  const std::unique_ptr<Rig> rig = RigOf(Delayed("sensor", 1.7e-4));
  ASSERT_NE(rig, nullptr);
  const Result<std::unique_ptr<Solver>> solver = MakeSolver("referense", *rig);
  ASSERT_FALSE(solver.ok());
  EXPECT_NE(solver.failure().message.find("referense"), std::string::npos);
}

TEST(StepOrder, AFrameSavedAndPutBackRepeatsItself) {
  Plan plan = Delayed("sensor", 1.7e-4);
  plan.root["plant"]["load"]["friction"] = Value{{"on", "I"}, {"law", "coulomb"}, {"T_c_Nm", 0.3}};
  plan.root["output"]["w"]["sensor"].array().push_back(Value{{"type", "noise"}, {"std", 0.1}});
  const std::unique_ptr<Rig> rig = RigOf(plan);
  ASSERT_NE(rig, nullptr);
  for (const char* name : kSolvers) {
    Result<std::unique_ptr<Solver>> solver = MakeSolver(name, *rig);
    ASSERT_TRUE(solver.ok());
    Simulation simulation(*rig, **solver);
    ASSERT_FALSE(simulation.Start());
    const auto run = [&simulation](int steps) {
      for (int i = 0; i < steps; ++i) {
        ASSERT_FALSE(simulation.Tick());
        ASSERT_FALSE(simulation.Integrate());
      }
    };
    run(13);
    const Frame saved = simulation.frame();
    run(40);
    const Frame later = simulation.frame();
    simulation.Restore(saved);
    run(40);
    EXPECT_NE(later, saved);
    // `reference` begins with the step it used last, which belongs to its past: equal up to its tolerance, not in bits.
    if (std::string(name) == "realtime") {
      EXPECT_EQ(simulation.frame(), later);
    }
    ASSERT_EQ(simulation.frame().states.size(), later.states.size());
    for (std::size_t i = 0; i < later.states.size(); ++i)
      EXPECT_NEAR(simulation.frame().states[i], later.states[i], 1e-9);
  }
}

TEST(StepOrder, TheSameRunGivesTheSameBits) {
  const Plan plan = Delayed("actuator", 0.9e-4);
  for (const char* solver : kSolvers) {
    const Samples first = RunPlan(plan, solver), second = RunPlan(plan, solver);
    EXPECT_EQ(first.outputs, second.outputs);
    EXPECT_EQ(first.counters, second.counters);
  }
}

TEST(StepOrder, ARunThatDivergesIsBrokenNotWrong) {
  Plan plan = OneMass(1.0, Value{{"type", "constant"}, {"value", 1.0}}, 0.5);
  // Negative drag accelerates: w' = 1 + 1e9 w^2 runs to infinity within 0.1 ms.
  plan.root["plant"]["load"]["anti"] = Value{{"on", "I"}, {"law", "constant"}, {"T_0_Nm", -1e308}};
  plan.root["plant"]["inertia"]["I"] = Value(1e-100);
  const std::unique_ptr<Rig> rig = RigOf(plan);
  ASSERT_NE(rig, nullptr);
  for (const char* name : kSolvers) {
    Result<std::unique_ptr<Solver>> solver = MakeSolver(name, *rig);
    ASSERT_TRUE(solver.ok());
    const Result<Samples> samples = Simulate(*rig, **solver);
    ASSERT_FALSE(samples.ok()) << name;
    EXPECT_EQ(samples.failure().exit_code, 3);
    EXPECT_TRUE(samples.failure().time_s.has_value());
  }
}

}  // namespace
}  // namespace dynoproof::testing
