// Both solvers on nonlinear drive lines: closed forms where there are any, order of convergence, agreement elsewhere.
#include <cmath>
#include <map>
#include <numbers>

#include "tests/support/plan_builder.h"
#include "tests/support/run_plan.h"

namespace dynoproof::testing {
namespace {

/// A mass that coasts down under dry friction stops after w0 I / T_c and stays where it is.
TEST(DryFriction, CoastsDownStopsAndSticks) {
  Plan plan = OneMass(0.5, Value{{"type", "step"}, {"initial", 0.2}, {"value", 0.2}, {"time_s", 0.0}}, 0.4);
  plan.root["plant"]["initial_speed_rad_per_s"] = Value(2.0);
  plan.root["plant"]["load"]["friction"] = Value{{"on", "I"}, {"law", "coulomb"}, {"T_c_Nm", 5.0}};
  const double stop = 2.0 * 0.5 / (5.0 - 0.2);  // friction less the driving torque
  for (const char* solver : {"realtime", "reference"}) {
    const Samples samples = RunPlan(plan, solver);
    for (std::size_t k = 0; k < samples.time.size(); ++k) {
      const double t = samples.time[k];
      EXPECT_NEAR(samples.outputs[0][k], std::max(0.0, 2.0 - (5.0 - 0.2) / 0.5 * t), 1e-9) << solver << " t " << t;
    }
    EXPECT_EQ(samples.outputs[0].back(), samples.outputs[0][samples.outputs[0].size() - 100]) << "it sticks";
    EXPECT_NEAR(samples.outputs[0].back(), 0.0, 1e-12);
    EXPECT_NEAR(samples.outputs[1].back(), 0.5 * 2.0 * stop, 1e-9) << solver;
  }
}

/// A held torque below the limit moves nothing; above it breaks away at once.
TEST(DryFriction, BreaksAwayWhenTheHeldTorqueJumpsAboveTheLimit) {
  Plan plan = OneMass(
      1.0,
      Value{{"type", "jump"}, {"times_s", Value::Array{0.01, 0.02, 0.03}}, {"values", Value::Array{0.9, 1.5, 0.0}}},
      0.05);
  plan.root["plant"]["load"]["friction"] = Value{{"on", "I"}, {"law", "coulomb"}, {"T_c_Nm", 1.0}};
  for (const char* solver : {"realtime", "reference"}) {
    const Samples samples = RunPlan(plan, solver);
    for (std::size_t k = 0; k < samples.time.size(); ++k) {
      const double t = samples.time[k];
      const double driven = 0.5 * std::clamp(t - 0.02, 0.0, 0.01), braked = std::max(0.0, t - 0.03);
      EXPECT_NEAR(samples.outputs[0][k], std::max(0.0, driven - braked), 5e-5) << solver << " t " << t;
    }
  }
}

/// Who slips on has the torques of both ends of a substep: w' = -(T_c + b w) / I in closed form, second order.
TEST(DryFriction, SlipsWithSecondOrder) {
  const auto error = [](int substeps) {
    Plan plan = OneMass(0.5, Value{{"type", "constant"}, {"value", 0.0}}, 0.3);
    plan.root["plant"]["initial_speed_rad_per_s"] = Value(2.0);
    plan.root["plant"]["load"]["friction"] =
        Value{{"on", "I"},         {"law", "asymmetric"},      {"T_c_pos_Nm", 1.0},
              {"T_c_neg_Nm", 4.0}, {"b_pos_Nms_per_rad", 3.0}, {"b_neg_Nms_per_rad", 0.0}};
    plan.root["run"]["realtime"] = Value{{"substeps", substeps}};
    const Samples samples = RunPlan(plan, "realtime");
    const double exact = (2.0 + 1.0 / 3.0) * std::exp(-6.0 * samples.time.back()) - 1.0 / 3.0;
    return std::abs(samples.outputs[0].back() - exact);
  };
  EXPECT_LT(error(1), 1e-7);
  EXPECT_NEAR(std::log2(error(1) / error(2)), 2.0, 0.3);
}

/// A motion that turns round without a rest turns within a substep, and so does the friction; an undamped mode beside
/// it remembers any other impulse.
TEST(DryFriction, TurnsRoundWithSecondOrder) {
  const auto speeds = [](int substeps) {
    Plan plan = OneMass(
        0.1, Value{{"type", "sine_sum"}, {"amplitudes", Value::Array{50.0}}, {"frequencies_Hz", Value::Array{37.0}}},
        0.2);
    plan.root["plant"]["inertia"]["wall"] = Value(1e6);
    plan.root["plant"]["shaft"]["k"] = Value{{"between", Value::Array{"I", "wall"}}, {"stiffness_Nm_per_rad", 1e6}};
    plan.root["plant"]["load"]["friction"] = Value{{"on", "I"}, {"law", "coulomb"}, {"T_c_Nm", 10.0}};
    plan.root["run"]["realtime"] = Value{{"substeps", substeps}};
    return RunPlan(plan, "realtime").outputs[0];
  };
  const auto distance = [exact = speeds(256)](const std::vector<double>& run) {
    double sum = 0.0;
    for (std::size_t k = 0; k < run.size(); ++k) sum += std::pow(run[k] - exact[k], 2);
    return std::sqrt(sum / static_cast<double>(run.size()));
  };
  const double coarse = distance(speeds(2)), fine = distance(speeds(16));
  EXPECT_LT(coarse, 1e-3);
  EXPECT_GT(std::log2(coarse / fine) / 3.0, 1.6) << coarse << ", " << fine;
}

/// Undamped pendulum-like shaft with cubic stiffness to a heavy body: energy is conserved, both solvers agree, and the
/// error of `realtime` falls with the square of the substep.
TEST(CubicSpring, RealtimeConvergesWithSecondOrder) {
  const auto plan = [](int substeps) {
    Plan p = OneMass(
        0.1, Value{{"type", "sine_sum"}, {"amplitudes", Value::Array{50.0}}, {"frequencies_Hz", Value::Array{40.0}}},
        0.2);
    p.root["plant"]["inertia"]["wall"] = Value(1e6);
    p.root["plant"]["shaft"]["k"] = Value{{"between", Value::Array{"I", "wall"}},
                                          {"law", "cubic_spring"},
                                          {"stiffness_Nm_per_rad", 1e4},
                                          {"damping_Nms_per_rad", 0.5},
                                          {"k3_Nm_per_rad3", 3e9}};
    p.root["run"]["realtime"] = Value{{"substeps", substeps}, {"corrections", 4}};
    p.root["run"]["reference"] = Value{{"relative_tolerance", 1e-12}};
    return p;
  };
  const Samples exact = RunPlan(plan(1), "reference");
  double error[3];
  for (int i = 0; i < 3; ++i) error[i] = Nrmse(exact.outputs[0], RunPlan(plan(1 << i), "realtime").outputs[0]);
  for (int i = 0; i < 2; ++i)
    EXPECT_NEAR(std::log2(error[i] / error[i + 1]), 2.0, 0.3) << error[i] << " " << error[i + 1];
  EXPECT_LT(error[2], 1e-4);
}

struct Case {
  const char* name;
  Value load;
  double tolerance;  // distance of the solvers: worst seen over this suite's excitation, times 3
};

/// Every load law on a chain with resonances, driven by a multisine: `realtime` against `reference`.
TEST(Loads, SolversAgreeOnAChain) {
  const Case cases[] = {
      {"viscous", Value{{"law", "viscous"}, {"b_Nms_per_rad", 3.0}}, 1e-8},
      {"quadratic", Value{{"law", "quadratic_drag"}, {"b2_Nms2_per_rad2", 20.0}}, 1e-4},
      {"constant", Value{{"law", "constant"}, {"T_0_Nm", 20.0}}, 1e-7},
      {"ripple", Value{{"law", "ripple"}, {"A_Nm", 30.0}, {"n", 6.0}}, 1e-4},
      {"dahl", Value{{"law", "dahl"}, {"F_c_Nm", 40.0}, {"sigma_Nm_per_rad", 2e5}}, 5e-3},
      {"coulomb", Value{{"law", "coulomb"}, {"T_c_Nm", 40.0}}, 5e-3},
      {"stribeck", Value{{"law", "stribeck"}, {"T_c_Nm", 30.0}, {"T_s_Nm", 45.0}, {"w_s_rad_per_s", 0.5}}, 2.5e-2},
      {"asymmetric",
       Value{{"law", "asymmetric"}, {"T_c_pos_Nm", 40.0}, {"T_c_neg_Nm", 25.0}, {"b_pos_Nms_per_rad", 2.0}}, 5e-3},
  };
  for (const Case& one : cases) {
    Plan plan = LumpedPlan();
    plan.root["run"] = Value{{"duration_s", 0.5}, {"reference", Value{{"relative_tolerance", 1e-10}}}};
    plan.root["plant"]["load"] = Value{{"load", one.load}};
    plan.root["plant"]["load"]["load"]["on"] = Value("I5");
    plan.root["input"]["T_airgap"]["source"] =
        Value{{"type", "multisine"}, {"low_Hz", 2.0}, {"high_Hz", 600.0}, {"lines", 60}, {"rms", 300.0}, {"seed", 5}};
    plan.root["output"]["T_shaft"].Erase("sensor");
    plan.root["output"]["w5"] = Value{{"of", "plant.I5.speed"}};
    const Samples reference = RunPlan(plan, "reference"), realtime = RunPlan(plan, "realtime");
    for (const std::size_t output : {0u, 2u}) {
      EXPECT_LT(Nrmse(reference.outputs[output], realtime.outputs[output]), one.tolerance)
          << one.name << " output " << output;
    }
  }
}

/// It needs no substeps: their number changes no bit.
TEST(Loads, AConstantOneIsHeldLikeAnInput) {
  const auto samples = [](int substeps) {
    Plan plan = LumpedPlan();
    plan.root["run"] = Value{{"duration_s", 0.1}, {"realtime", Value{{"substeps", substeps}}}};
    plan.root["plant"]["load"]["load"] = Value{{"on", "I5"}, {"law", "constant"}, {"T_0_Nm", 20.0}};
    return RunPlan(plan, "realtime");
  };
  const Samples once = samples(1);
  EXPECT_EQ(once.outputs, samples(16).outputs);
  EXPECT_NE(once.outputs.front().front(), once.outputs.front().back());
}

/// Angles are sums of twists: a tiny one beside a large one comes back from them rounded, and is no fault of the plan.
TEST(Twists, OneOfAnySizeMayStandBesideAnother) {
  Plan plan = LumpedPlan();
  plan.root["run"] = Value{{"duration_s", 0.01}};
  plan.root["plant"]["shaft"]["k1"]["initial_twist_rad"] = Value(1e-3);
  plan.root["plant"]["shaft"]["k2"]["initial_twist_rad"] = Value(3e-15);
  EXPECT_EQ(RunPlan(plan, "realtime").time.size(), 101u);
}

/// A lag, then a saturation, then the plant: the saturation works on the continuous signal between.
TEST(Parts, NonlinearStageBetweenLinearOnes) {
  Plan plan = OneMass(1.0, Value{{"type", "step"}, {"value", 2.0}, {"time_s", 1e-4}}, 0.01);
  plan.root["input"]["T"]["actuator"] = Value(
      Value::Array{Value{{"type", "first_order_lag"}, {"tau_s", 2e-3}}, Value{{"type", "saturation"}, {"limit", 1.0}}});
  const double full = 2e-3 * std::numbers::ln2;  // the lagged torque reaches the limit
  for (const auto& [solver, tolerance] : {std::pair("reference", 1e-8), std::pair("realtime", 1e-6)}) {
    const Samples samples = RunPlan(plan, solver);
    for (std::size_t k = 0; k < samples.time.size(); ++k) {
      const double since = std::max(0.0, samples.time[k] - 1e-4), t = std::min(since, full);
      const double speed = 2.0 * (t + 2e-3 * std::expm1(-t / 2e-3)) + std::max(0.0, since - full);
      EXPECT_NEAR(samples.outputs[0][k], speed, tolerance) << solver;  // realtime: kink inside a substep, O(h^2)
    }
  }
}

/// Sensor stages of every kind behind each other, in both orders: each sample passes all of them at its own instant.
TEST(Parts, SensorStagesInAnyOrderShowTheSameInstant) {
  const std::map<std::string, Value> stages = {{"gain", Value{{"type", "gain"}, {"gain", 2.0}}},
                                               {"offset", Value{{"type", "offset"}, {"offset", -0.3}}},
                                               {"rectified", Value{{"type", "rectified"}}},
                                               {"range", Value{{"type", "range"}, {"low", -0.2}, {"high", 0.4}}},
                                               {"first_order_lag", Value{{"type", "first_order_lag"}, {"tau_s", 2e-3}}},
                                               {"delay", Value{{"type", "delay"}, {"delay_s", 2.3e-4}}}};
  for (const auto& [first, a] : stages) {
    for (const auto& [second, b] : stages) {
      Plan plan = OneMass(
          1.0, Value{{"type", "chirp"}, {"amplitude", 50.0}, {"start_Hz", 20.0}, {"end_Hz", 70.0}, {"duration_s", 0.1}},
          0.1);
      plan.root["output"]["w"]["sensor"] = Value(Value::Array{a, b});
      const Samples reference = RunPlan(plan, "reference"), realtime = RunPlan(plan, "realtime");
      // A sample late would be 5e-3 and more; a kink inside a substep of a lag is 1e-5.
      EXPECT_LT(Nrmse(reference.outputs[0], realtime.outputs[0]), 1e-4) << first << " then " << second;
    }
  }
}

}  // namespace
}  // namespace dynoproof::testing
