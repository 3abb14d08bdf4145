// Controls that read one another: what they are called must never show in a result.
#include <gmock/gmock.h>

#include "tests/support/run_plan.h"

namespace dynoproof::testing {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

/// A control that gives 1 more than half of `reference`: the mass stands still.
Value HalfAndOne(const std::string& reference) {
  return {{"type", "speed_pi"},       {"k_P_Nms_per_rad", 0.5},
          {"k_I_Nm_per_rad", 0.0},    {"limit_Nm", 1e6},
          {"initial_torque_Nm", 1.0}, {"inputs", Value{{"reference", reference}, {"speed", "output.w"}}}};
}

/// Two controls under these names, of which each reads the other.
Plan Circle(const std::string& first, const std::string& second) {
  Plan plan = OneMass(1e9, Value{{"type", "constant"}, {"value", 0.0}}, 0.001);
  plan.root["control"][first] = HalfAndOne("control." + second + ".torque");
  plan.root["control"][second] = HalfAndOne("control." + first + ".torque");
  plan.root["output"]["first"] = Value{{"of", "control." + first + ".torque"}};
  plan.root["output"]["second"] = Value{{"of", "control." + second + ".torque"}};
  return plan;
}

std::string FaultsOf(const Plan& plan) {
  Diagnostics diagnostics;
  EXPECT_EQ(Rig::Build(plan, BuiltIns(), {}, diagnostics), nullptr);
  return diagnostics.Format();
}

TEST(ControlOrder, ACircleAtOneInstantIsAFault) {
  EXPECT_THAT(FaultsOf(Circle("a", "b")),
              AllOf(HasSubstr("in a circle: control.a reads control.b reads control.a"), HasSubstr("offset_s")));
  Plan three = Circle("a", "b");
  three.root["control"]["b"] = HalfAndOne("control.c.torque");
  three.root["control"]["c"] = HalfAndOne("control.a.torque");
  three.root["control"]["0_behind"] = HalfAndOne("control.a.torque");  // reads the circle, is not of it
  EXPECT_THAT(FaultsOf(three), HasSubstr("in a circle: control.a reads control.b reads control.c reads control.a\n"));
}

/// Periods of 2 and 3 ticks meet at every sixth, unless offsets of equal remainder keep them apart: 2 and 4, 1 tick on.
TEST(ControlOrder, ACircleThatMeetsNowAndThenIsAFaultToo) {
  Plan plan = Circle("a", "b");
  plan.root["control"]["a"]["period_s"] = Value(2e-4);
  plan.root["control"]["b"]["period_s"] = Value(3e-4);
  plan.root["control"]["b"]["offset_s"] = Value(1e-4);
  EXPECT_THAT(FaultsOf(plan), HasSubstr("in a circle"));
}

/// A control has no output before its first tick, so that the first samples of what shows it cannot be compared with a record.
TEST(ControlOrder, AnOutputKnowsNothingOfAControlBeforeItsFirstTick) {
  Plan plan = Circle("a", "b");
  for (const char* name : {"a", "b"}) plan.root["control"][name]["period_s"] = Value(2e-4);
  plan.root["control"]["b"]["offset_s"] = Value(1e-4);
  plan.root["output"]["late"] =
      Value{{"of", "control.a.torque"}, {"sensor", Value::Array{Value{{"type", "delay"}, {"delay_s", 3e-4}}}}};
  const std::unique_ptr<Rig> rig = RigOf(plan);
  std::map<std::string, double> from;
  for (std::size_t k = 0; k < rig->outputs.size(); ++k) from[rig->outputs[k].name] = rig->KnownFrom()[k];
  EXPECT_NEAR(from.at("first"), 0.5e-4, 1e-12);
  EXPECT_NEAR(from.at("second"), 1.5e-4, 1e-12);
  EXPECT_NEAR(from.at("late"), 3.5e-4, 1e-12);
  EXPECT_EQ(from.at("w"), 0.0) << "a speed follows a torque by and by";
}

/// Where time orders them, names do not matter: each tick takes what the other gave at the tick before.
TEST(ControlOrder, OffsetsOrderACircleWhateverItsNames) {
  for (const auto& [first, second] : {std::pair("a", "b"), std::pair("b", "a")}) {
    Plan plan = Circle(first, second);
    for (const char* name : {"a", "b"}) plan.root["control"][name]["period_s"] = Value(2e-4);
    plan.root["control"][second]["offset_s"] = Value(1e-4);
    const Samples samples = RunPlan(plan, "realtime");
    ASSERT_EQ(samples.time.size(), 11u);
    std::map<std::string, std::vector<double>> rows;
    const std::unique_ptr<Rig> rig = RigOf(plan);
    for (std::size_t k = 0; k < rig->outputs.size(); ++k) rows[rig->outputs[k].name] = samples.outputs[k];
    // Sums of powers of two: exact. Row k shows the samples that were taken before tick k, and nothing was given before 0.
    double at_first = 0.0, at_second = 0.0;
    for (std::size_t k = 0; k < samples.time.size(); ++k) {
      EXPECT_EQ(rows["first"][k], at_first) << first << " row " << k;
      EXPECT_EQ(rows["second"][k], at_second) << first << " row " << k;
      (k % 2 == 0 ? at_first : at_second) = 1.0 + 0.5 * (k % 2 == 0 ? at_second : at_first);
    }
  }
}

/// A control that reads itself reads its last tick: nobody else's place matters.
TEST(ControlOrder, AControlMayReadItself) {
  Plan plan = OneMass(1e9, Value{{"type", "constant"}, {"value", 0.0}}, 0.001);
  plan.root["control"]["a"] = HalfAndOne("control.a.torque");
  plan.root["output"]["own"] = Value{{"of", "control.a.torque"}};
  const Samples samples = RunPlan(plan, "realtime");
  const std::unique_ptr<Rig> rig = RigOf(plan);
  double expected = 0.0;
  for (std::size_t k = 0; k < rig->outputs.size(); ++k) {
    if (rig->outputs[k].name != "own") continue;
    for (const double value : samples.outputs[k]) {
      EXPECT_EQ(value, expected);
      expected = 1.0 + 0.5 * expected;
    }
  }
  EXPECT_GT(expected, 1.9) << "the output was not found";
}

}  // namespace
}  // namespace dynoproof::testing
