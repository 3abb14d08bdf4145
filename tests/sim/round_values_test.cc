// Guards that are exactly 0 at a tick: torques that meet a limit, times that fall on ticks, events that coincide. Round
// numbers make that common. Both solvers agree, and no passive law gives energy.
#include <algorithm>
#include <cmath>
#include <tuple>

#include "tests/support/plan_builder.h"
#include "tests/support/run_plan.h"

namespace dynoproof::testing {
namespace {

/// A torque that jumps at round times.
struct Jumps {
  std::vector<double> times_s, values;
  Value Source() const {
    Value::Array times, levels;
    for (const double time_s : times_s) times.push_back(Value(time_s));
    for (const double value : values) levels.push_back(Value(value));
    return {{"type", "jump"}, {"times_s", times}, {"values", levels}};
  }
  double At(double time_s) const {
    double value = 0.0;
    for (std::size_t i = 0; i < times_s.size() && times_s[i] <= time_s + 1e-9; ++i) value = values[i];
    return value;
  }
};

/// One body of 0.5 kg m^2 at this speed, a law to the ground, ticks of 1 ms.
Plan Braked(const Jumps& torque, const Value& law, double speed) {
  Plan plan = OneMass(0.5, torque.Source(), 1.0);
  plan.root["run"]["period_s"] = Value(1e-3);
  plan.root["plant"]["initial_speed_rad_per_s"] = Value(speed);
  plan.root["plant"]["load"]["friction"] = law;
  return plan;
}

/// The most energy [J] that a period of OneMass(0.5, ...) gains beyond the work of its held torque.
double EnergyFromNowhere(const Samples& samples, const Jumps& torque) {
  double most = 0.0;
  const std::vector<double>&w = samples.outputs[0], &phi = samples.outputs[1];
  for (std::size_t k = 0; k + 1 < w.size(); ++k) {
    const double gained = 0.25 * (w[k + 1] * w[k + 1] - w[k] * w[k]);
    most = std::max(most, gained - torque.At(samples.time[k]) * (phi[k + 1] - phi[k]));
  }
  return most;
}

double Farthest(const std::vector<double>& a, const std::vector<double>& b) {
  double most = a.size() == b.size() ? 0.0 : INFINITY;
  for (std::size_t i = 0; i < std::min(a.size(), b.size()); ++i) most = std::max(most, std::abs(a[i] - b[i]));
  return most;
}

/// A torque that meets the limit exactly holds; what exceeds it accelerates; without a torque the friction brakes, as
/// hard as its limit, until it rests. Closed form.
TEST(RoundValues, ATorqueThatMeetsTheFrictionHolds) {
  const Jumps torque{{0.1, 0.2, 0.4}, {10.0, 12.0, 0.0}};
  const Plan plan = Braked(torque, {{"on", "I"}, {"law", "coulomb"}, {"T_c_Nm", 10.0}}, 0.0);
  for (const char* solver : {"realtime", "reference"}) {
    const Samples samples = RunPlan(plan, solver);
    for (std::size_t k = 0; k < samples.time.size(); ++k) {
      const double t = samples.time[k];
      const double exact = std::max(0.0, 4.0 * std::clamp(t - 0.2, 0.0, 0.2) - 20.0 * std::max(0.0, t - 0.4));
      EXPECT_NEAR(samples.outputs[0][k], exact, 1e-10) << solver << " t " << t;
    }
  }
}

/// Dry friction of every kind under torques of 0, 1, 2 times its limits, from rest and from speeds that come to rest at
/// a tick.
TEST(RoundValues, FrictionTakesEnergyAndBothSolversAgree) {
  const Value laws[] = {{{"on", "I"}, {"law", "coulomb"}, {"T_c_Nm", 10.0}},
                        {{"on", "I"}, {"law", "coulomb"}, {"T_c_Nm", 0.0}},
                        {{"on", "I"}, {"law", "stribeck"}, {"T_c_Nm", 5.0}, {"T_s_Nm", 10.0}, {"w_s_rad_per_s", 1.0}},
                        {{"on", "I"},
                         {"law", "asymmetric"},
                         {"T_c_pos_Nm", 10.0},
                         {"T_c_neg_Nm", 5.0},
                         {"b_pos_Nms_per_rad", 1.0},
                         {"b_neg_Nms_per_rad", 0.0}},
                        {{"on", "I"}, {"law", "asymmetric"}, {"T_c_pos_Nm", 10.0}, {"T_c_neg_Nm", 0.0}}};
  const std::vector<double> levels[] = {{10, 12, 0},   {-10, -12, 0}, {10, 20, -10}, {20, -20, 10}, {5, -5, 10},
                                        {10, -10, 20}, {0, 10, 0},    {20, 10, -10}, {-5, -10, 5}};
  for (const Value& law : laws) {
    for (const std::vector<double>& values : levels) {
      for (const double speed : {0.0, 2.0, -4.0}) {
        for (const double begin : {0.0, 0.1}) {
          const Jumps torque{{begin, 0.2, 0.4}, values};
          const Plan plan = Braked(torque, law, speed);
          const std::string what = law.TextOr("law") + " " + std::to_string(values[0]) + " " +
                                   std::to_string(values[1]) + " " + std::to_string(values[2]) + " speed " +
                                   std::to_string(speed) + " begin " + std::to_string(begin);
          SCOPED_TRACE(what);
          const Samples reference = RunPlan(plan, "reference"), realtime = RunPlan(plan, "realtime");
          if (reference.time.empty() || realtime.time.empty()) continue;
          // The integrator's relative tolerance of 1e-9 on some 50 J.
          EXPECT_LT(EnergyFromNowhere(reference, torque), 1e-7) << what;
          // Speeds are some 10 rad/s; a substep of `realtime` is second order.
          EXPECT_LT(Farthest(reference.outputs[0], realtime.outputs[0]), 1e-4) << what;
        }
      }
    }
  }
}

/// Several frictions that the same jump sets free at one instant, on one body and on two.
TEST(RoundValues, EventsOfOneInstantAreAllTold) {
  const Jumps torque{{0.1, 0.2, 0.3}, {10.0, 20.0, 0.0}};
  Plan plan = OneMass(0.5, torque.Source(), 0.5);
  plan.root["run"]["period_s"] = Value(1e-3);
  plan.root["plant"]["inertia"]["J"] = Value(0.5);
  plan.root["plant"]["shaft"]["k"] = Shaft("I", "J", 1e4, 1.0);  // both move alike: it stays unwound
  plan.root["plant"]["torque"]["T_J"] = Value{{"on", "J"}};
  plan.root["input"]["T_J"] = Value{{"to", "plant.T_J"}, {"source", torque.Source()}};
  plan.root["output"]["w_J"] = Value{{"of", "plant.J.speed"}};
  for (const char* body : {"I", "J"}) {
    for (const char* which : {"_1", "_2"}) {
      plan.root["plant"]["load"][std::string(body) + which] = Value{{"on", body}, {"law", "coulomb"}, {"T_c_Nm", 5.0}};
    }
  }
  for (const char* solver : {"realtime", "reference"}) {
    const Samples samples = RunPlan(plan, solver);
    for (std::size_t k = 0; k < samples.time.size(); ++k) {
      const double t = samples.time[k];
      const double exact = std::max(0.0, 20.0 * std::clamp(t - 0.2, 0.0, 0.1) - 20.0 * std::max(0.0, t - 0.3));
      EXPECT_NEAR(samples.outputs[0][k], exact, 1e-9) << solver << " I at " << t;
      EXPECT_NEAR(samples.outputs[2][k], exact, 1e-9) << solver << " J at " << t;
    }
  }
}

/// A clutch between two bodies whose second one is braked: what exceeds the clutch drives the first body alone.
TEST(RoundValues, AClutchThatMeetsItsLimit) {
  const Jumps torque{{0.1, 0.2, 0.4}, {16.0, 20.0, 0.0}};
  Plan plan = OneMass(0.5, torque.Source(), 1.0);
  plan.root["run"]["period_s"] = Value(1e-3);
  plan.root["plant"]["inertia"]["J"] = Value(0.5);
  plan.root["plant"]["shaft"]["clutch"] =
      Value{{"between", Value::Array{"I", "J"}}, {"law", "coulomb"}, {"T_c_Nm", 8.0}};
  plan.root["output"]["w_J"] = Value{{"of", "plant.J.speed"}};
  for (const char* solver : {"realtime", "reference"}) {
    const Samples samples = RunPlan(plan, solver);
    for (std::size_t k = 0; k < samples.time.size(); ++k) {
      // 16 N m is 8 through the clutch: locked. Then 12 for I, 8 for J; without a torque -8 and 8 until they meet.
      const double t = samples.time[k], locked = 16.0 * std::clamp(t - 0.1, 0.0, 0.1);
      const double apart = std::clamp(t - 0.2, 0.0, 0.2), meet = std::clamp(t - 0.4, 0.0, 0.05);
      EXPECT_NEAR(samples.outputs[0][k], locked + 24.0 * apart - 16.0 * meet, 1e-9) << solver << " I at " << t;
      EXPECT_NEAR(samples.outputs[2][k], locked + 16.0 * apart + 16.0 * meet, 1e-9) << solver << " J at " << t;
    }
  }
}

/// A clutch that closes within a substep, and thereby asks more of the next one than it can hold: that one slips from the
/// instant at which the first one closes, not from the substep's begin. All torques are constant in between.
TEST(RoundValues, AClutchThatClosesSetsAnotherFree) {
  const Jumps none{{0.0}, {0.0}};
  Plan plan = OneMass(1.0, none.Source(), 0.06);
  plan.root["run"]["period_s"] = Value(1e-3);
  Value& plant = plan.root["plant"];
  plant["inertia"] = Value{{"I", 1.0}, {"J", 1.0}, {"K", 1.0}};
  for (const auto& [name, a, b, T_c, rate] :
       {std::tuple("first", "I", "J", 20.0, -1.313), std::tuple("second", "J", "K", 5.0, 0.0)}) {
    plant["shaft"][name] = Value{
        {"between", Value::Array{a, b}}, {"law", "coulomb"}, {"T_c_Nm", T_c}, {"initial_twist_rate_rad_per_s", rate}};
  }
  plant["torque"]["T_K"] = Value{{"on", "K"}};
  plan.root["input"]["T_K"] = Value{{"to", "plant.T_K"}, {"source", Value{{"type", "constant"}, {"value", -20.0}}}};
  for (const char* body : {"J", "K"})
    plan.root["output"][std::string("w_") + body] = Value{{"of", std::string("plant.") + body + ".speed"}};
  for (const char* solver : {"realtime", "reference"}) {
    const Samples samples = RunPlan(plan, solver);
    // The rounds in which `realtime` settles what stops and what breaks away end where 6e-6 rad/s are left; from the
    // substep's begin it would be 4e-4.
    const double room = std::string(solver) == "realtime" ? 2e-5 : 1e-9;
    for (std::size_t k = 0; k < samples.time.size(); ++k) {
      // J and K lose 20 rad/s^2 each and the second clutch bears nothing; locked to I it would have to bear 40/3.
      const double t = samples.time[k], closes_s = 1.313 / 40.0;
      const double before = std::min(t, closes_s), after = std::max(0.0, t - closes_s);
      EXPECT_NEAR(samples.outputs[0][k], 20.0 * before - 2.5 * after, room) << solver << " I at " << t;
      EXPECT_NEAR(samples.outputs[2][k], 1.313 - 20.0 * before - 2.5 * after, room) << solver << " J at " << t;
      EXPECT_NEAR(samples.outputs[3][k], 1.313 - 20.0 * before - 15.0 * after, room) << solver << " K at " << t;
    }
  }
}

/// A clutch that sticks beside a brake that sticks: what one holds depends on what the other holds.
TEST(RoundValues, AClutchBesideABrakeThatHolds) {
  const Jumps torque{{0.1, 0.2, 0.3, 0.5}, {5.0, 8.0, 9.0, 0.0}};
  Plan plan = OneMass(0.5, torque.Source(), 1.0);
  plan.root["run"]["period_s"] = Value(1e-3);
  plan.root["plant"]["inertia"]["J"] = Value(0.5);
  plan.root["plant"]["shaft"]["clutch"] =
      Value{{"between", Value::Array{"I", "J"}}, {"law", "coulomb"}, {"T_c_Nm", 8.0}};
  plan.root["plant"]["load"]["brake"] = Value{{"on", "J"}, {"law", "coulomb"}, {"T_c_Nm", 10.0}};
  plan.root["output"]["w_J"] = Value{{"of", "plant.J.speed"}};
  for (const char* solver : {"realtime", "reference"}) {
    const Samples samples = RunPlan(plan, solver);
    for (std::size_t k = 0; k < samples.time.size(); ++k) {
      const double t = samples.time[k];
      const double slips = 2.0 * std::clamp(t - 0.3, 0.0, 0.2) - 16.0 * std::clamp(t - 0.5, 0.0, 0.025);
      EXPECT_NEAR(samples.outputs[0][k], slips, 1e-9) << solver << " I at " << t;
      EXPECT_NEAR(samples.outputs[2][k], 0.0, 1e-12) << solver << " J at " << t;
    }
  }
}

/// Two brakes of one body stop it at one instant, and hold what neither could hold alone.
TEST(RoundValues, TwoBrakesOfOneBodyAreOneFriction) {
  const Jumps torque{{0.0, 0.2, 0.3}, {-5.0, 20.0, 25.0}};
  Plan plan = Braked(torque, {{"on", "I"}, {"law", "coulomb"}, {"T_c_Nm", 10.0}}, 7.0);
  plan.root["plant"]["load"]["second"] = Value{{"on", "I"}, {"law", "coulomb"}, {"T_c_Nm", 10.0}};
  plan.root["output"]["T_1"] = Value{{"of", "plant.friction.torque"}};
  plan.root["output"]["T_2"] = Value{{"of", "plant.second.torque"}};
  for (const char* solver : {"realtime", "reference"}) {
    const Samples samples = RunPlan(plan, solver);
    for (std::size_t k = 0; k < samples.time.size(); ++k) {
      const double t = samples.time[k];
      EXPECT_NEAR(samples.outputs[0][k], std::max(0.0, 7.0 - 50.0 * t) + 10.0 * std::max(0.0, t - 0.3), 1e-9)
          << solver << " " << t;
      EXPECT_LE(std::max(std::abs(samples.outputs[2][k]), std::abs(samples.outputs[3][k])), 10.0 + 1e-9) << solver;
    }
  }
}

/// The membrane of the gas valve under a force that meets its friction, and half as much and twice as much.
TEST(RoundValues, AValveThatSticksAtItsLimit) {
  for (const double step_Pa : {500.0, 1000.0, 2000.0}) {
    Plan plan = GasPlan();
    plan.root["plant"]["valve"]["v_g"]["friction_N"] = Value(20.0);
    plan.root["input"]["p_mem"]["source"] =
        Jumps{{0.0, 0.1, 0.4, 0.7}, {5e5, 5e5 + step_Pa, 5e5 - step_Pa, 5e5}}.Source();
    const Samples reference = RunPlan(plan, "reference"), realtime = RunPlan(plan, "realtime");
    for (std::size_t i = 0; i < reference.outputs.size(); ++i) {
      double largest = 0.0;
      for (const double value : reference.outputs[i]) largest = std::max(largest, std::abs(value));
      EXPECT_LT(Farthest(reference.outputs[i], realtime.outputs[i]), 1e-4 * largest) << step_Pa << " output " << i;
    }
  }
}

/// Stages with kinks that a settled signal meets exactly, and play: the plant behind them moves alike with both.
TEST(RoundValues, StagesAtTheirLimits) {
  const Value stages[] = {{{"type", "saturation"}, {"limit", 10.0}},
                          {{"type", "dead_zone"}, {"width", 20.0}},
                          {{"type", "play"}, {"width", 20.0}}};
  for (const Value& stage : stages) {
    const Jumps torque{{0.1, 0.2, 0.4, 0.6}, {10.0, 12.0, -10.0, 0.0}};
    Plan plan = Braked(torque, {{"on", "I"}, {"law", "coulomb"}, {"T_c_Nm", 2.0}}, 0.0);
    plan.root["input"]["T"]["actuator"] = Value(Value::Array{stage});
    const Samples reference = RunPlan(plan, "reference"), realtime = RunPlan(plan, "realtime");
    EXPECT_LT(Farthest(reference.outputs[0], realtime.outputs[0]), 1e-6) << stage.TextOr("type");
  }
}

/// Shafts with play that begin on the edge of their gap, at rest: nothing moves until the torque does, and no law with
/// play gives energy. Kinetic energy stays below the work of the torque, which the spring can only store.
TEST(RoundValues, PlayThatBeginsAtItsEdge) {
  for (const char* law : {"dead_zone", "revised_dead_zone", "phase_plane", "damped_dead_zone",
                          "damped_revised_dead_zone", "damped_phase_plane", "full_state_backlash"}) {
    for (const double twist : {0.0, 0.01, -0.01}) {
      const Jumps torque{{0.01, 0.02, 0.05}, {10.0, -10.0, 0.0}};
      Plan plan = OneMass(0.5, torque.Source(), 0.1);
      plan.root["plant"]["inertia"]["J"] = Value(0.5);
      Value shaft{{"between", Value::Array{"I", "J"}}, {"law", law},           {"stiffness_Nm_per_rad", 1e4},
                  {"damping_Nms_per_rad", 10.0},       {"half_gap_rad", 0.01}, {"initial_twist_rad", twist}};
      if (std::string(law).find("damped") == 0 || std::string(law).find("full") == 0)
        shaft["contact_free_damping_Nms_per_rad"] = Value(1.0);
      plan.root["plant"]["shaft"]["k"] = shaft;
      plan.root["output"]["w_J"] = Value{{"of", "plant.J.speed"}};
      const Samples reference = RunPlan(plan, "reference"), realtime = RunPlan(plan, "realtime");
      double work = 0.0;
      for (std::size_t k = 0; k + 1 < reference.time.size(); ++k) {
        const std::vector<double>&w = reference.outputs[0], &phi = reference.outputs[1], &w_J = reference.outputs[2];
        if (reference.time[k] < 0.01 - 1e-9) {
          EXPECT_EQ(w[k], 0.0) << law << twist;
        }
        work += torque.At(reference.time[k]) * (phi[k + 1] - phi[k]);
        EXPECT_LE(0.25 * (w[k + 1] * w[k + 1] + w_J[k + 1] * w_J[k + 1]), work + 1e-9) << law << " " << twist;
      }
      EXPECT_LT(Nrmse(reference.outputs[2], realtime.outputs[2]), 1e-2) << law << " " << twist;
    }
  }
}

}  // namespace
}  // namespace dynoproof::testing
