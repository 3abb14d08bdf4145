// What single effects do to a plan, place by place.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>

#include "linear/dense.h"
#include "linear/network.h"
#include "tests/support/build.h"
#include "tests/support/plan_builder.h"

namespace dynoproof {
namespace {

using testing::BuiltIns;
using ::testing::ElementsAre;
using testing::LumpedPlan;
using testing::Shaft;
using testing::SoftPlan;

std::vector<std::string> PlacesOf(const std::string& effect, const Plan& plan) {
  std::vector<std::string> places;
  for (const Place& place : BuiltIns().FindEffect(effect)->Places(plan)) places.push_back(place.ToString());
  return places;
}

void Apply(const std::string& effect, const std::string& at, std::vector<double> parameters, Plan& plan) {
  BuiltIns().FindEffect(effect)->Apply(plan, *ParsePlace(at), parameters);
}

double NumberAt(const Plan& plan, const std::string& path) {
  const Value* value = plan.root.FindPath(path);
  return value != nullptr && value->is_number() ? value->number() : std::nan("");
}

std::string TextAt(const Plan& plan, const std::string& path) {
  const Value* value = plan.root.FindPath(path);
  return value != nullptr && value->is_string() ? value->string() : "(no text)";
}

/// The undamped eigenfrequencies of a drive line's plan, rising [rad/s].
Eigen::VectorXd FrequenciesOf(const Plan& plan) {
  std::string faults;
  const std::unique_ptr<Component> plant = testing::Build("plant", *plan.root.Find("plant"), {}, &faults);
  EXPECT_NE(plant, nullptr) << faults;
  const mechanics::Network& network = *plant->network();
  const Eigen::VectorXd root = network.Inertias().cwiseSqrt().cwiseInverse();
  const Eigen::MatrixXd scaled = root.asDiagonal() * network.StiffnessMatrix() * root.asDiagonal();
  return dense::SymmetricValues(scaled).cwiseMax(0.0).cwiseSqrt();
}

TEST(LoadEffects, SitOnInertiasAndWholeRotors) {
  EXPECT_THAT(PlacesOf("coulomb_friction", SoftPlan()), ElementsAre("inertia:I4", "inertia:I5", "rotor:I1"));
}

TEST(LoadEffects, AddALawAndNeverOverwrite) {
  Plan plan = LumpedPlan();
  Apply("coulomb_friction", "inertia:I5", {0.2}, plan);
  Apply("coulomb_friction", "inertia:I4", {0.3}, plan);
  Apply("coulomb_friction", "inertia:I4", {0.4}, plan);
  EXPECT_THAT(KeysOf(*plan.root.FindPath("plant.load")),
              ElementsAre("fan", "coulomb_friction", "coulomb_friction_I4", "coulomb_friction_I4_2"));
  EXPECT_EQ(TextAt(plan, "plant.load.coulomb_friction.on"), "I5");
  EXPECT_EQ(TextAt(plan, "plant.load.coulomb_friction.law"), "coulomb");
  EXPECT_EQ(NumberAt(plan, "plant.load.coulomb_friction.T_c_Nm"), 0.2);
  EXPECT_EQ(NumberAt(plan, "plant.load.coulomb_friction_I4_2.T_c_Nm"), 0.4);
}

TEST(LoadEffects, BrakeAndDriveWithTheSignsOfTheContract) {
  struct Case {
    const char* effect;
    std::vector<double> parameters;
    double angle, speed, torque;  // torque added on the node
  };
  const Case cases[] = {
      {"viscous_friction", {0.5}, 0.0, -4.0, 2.0},
      {"coulomb_friction", {0.3}, 0.0, 2.0, -0.3},
      {"stribeck_friction", {0.2, 0.5, 2.0}, 0.0, -2.0, 0.2 + 0.3 * std::exp(-1.0)},
      {"asymmetric_friction", {0.2, 0.4, 0.1, 0.3}, 0.0, -2.0, 0.4 + 0.6},
      {"asymmetric_friction", {0.2, 0.4, 0.1, 0.3}, 0.0, 2.0, -0.2 - 0.2},
      {"constant_load", {7.0}, 0.0, -3.0, -7.0},
      {"quadratic_drag", {0.25}, 0.0, -4.0, 4.0},
      {"torque_ripple", {3.0, 4.0, 0.5}, 0.1, 1.0, 3.0 * std::sin(0.9)},
  };
  for (const Case& one : cases) {
    SCOPED_TRACE(one.effect);
    Plan plan = LumpedPlan();
    Apply(one.effect, "inertia:I5", one.parameters, plan);
    const auto law = testing::BuildLaw(*plan.root.FindPath(std::string("plant.load.") + one.effect));
    ASSERT_NE(law, nullptr);
    std::vector<int> modes(static_cast<std::size_t>(law->layout().modes));
    law->Start(one.angle, one.speed, {}, modes);
    EXPECT_DOUBLE_EQ(-law->Torque({0.0, one.angle, one.speed, 0.0, {}, modes}), one.torque);
  }
}

TEST(ParameterChanges, ScaleTheNominalValue) {
  Plan plan = LumpedPlan();
  Apply("inertia_change", "inertia:I5", {0.25}, plan);
  Apply("stiffness_change", "shaft:k3", {-0.5}, plan);
  EXPECT_DOUBLE_EQ(NumberAt(plan, "plant.inertia.I5"), 0.140 * 1.25);
  EXPECT_DOUBLE_EQ(NumberAt(plan, "plant.shaft.k3.stiffness_Nm_per_rad"), 1.68e6);
  Plan soft = SoftPlan();
  Apply("inertia_change", "rotor:I1", {0.1}, soft);
  Apply("damping_change", "rotor:I1", {1.0}, soft);
  EXPECT_DOUBLE_EQ(NumberAt(soft, "plant.rotor.I1.inertia_kg_m2"), 25.308 * 1.1);
  EXPECT_DOUBLE_EQ(NumberAt(soft, "plant.rotor.I1.damping_Nms_per_rad"), 171.2);
}

TEST(ParameterChanges, NoFactorMovesAZero) {
  // c3 and c4 of Table A.1 are 0.
  EXPECT_THAT(PlacesOf("damping_change", LumpedPlan()), ElementsAre("shaft:k1", "shaft:k2"));
  EXPECT_THAT(PlacesOf("stiffness_change", SoftPlan()), ElementsAre("shaft:k3", "shaft:k4", "rotor:I1"));
}

TEST(DistributedInertia, ReplacesTheRunByARotor) {
  Plan plan = LumpedPlan();
  EXPECT_THAT(PlacesOf("distributed_inertia", plan), ElementsAre("rotor:R"));
  Apply("distributed_inertia", "rotor:R", {25.308, 16.5e6, 85.6}, plan);
  EXPECT_THAT(KeysOf(*plan.root.FindPath("plant.inertia")), ElementsAre("I4", "I5"));
  EXPECT_THAT(KeysOf(*plan.root.FindPath("plant.shaft")), ElementsAre("k3", "k4"));
  EXPECT_EQ(plan.root.FindPath("plant.run"), nullptr);
  EXPECT_EQ(TextAt(plan, "plant.shaft.k3.between.0"), "R.right");
  EXPECT_EQ(TextAt(plan, "plant.torque.T_airgap.on"), "R");
  EXPECT_EQ(NumberAt(plan, "plant.torque.T_airgap.slices.0"), 6);
  EXPECT_EQ(NumberAt(plan, "plant.torque.T_airgap.slices.1"), 95);
  EXPECT_EQ(TextAt(plan, "plant.load.fan.on"), "R");
  EXPECT_EQ(TextAt(plan, "output.omega_1.of"), "plant.R.left.speed");
  // With the values of Table A.5 it is the plan of the soft rotor.
  plan.root["plant"]["inertia"] = *SoftPlan().root.FindPath("plant.inertia");
  plan.root["plant"]["shaft"]["k3"]["stiffness_Nm_per_rad"] = Value(5.1e6);
  plan.root["plant"]["shaft"]["k4"]["stiffness_Nm_per_rad"] = Value(7.99e6);
  const Eigen::VectorXd hertz = FrequenciesOf(plan) / (2.0 * M_PI);
  const double printed[] = {389.3, 549.1, 812.9, 1208.5, 1542.2};  // Table A.5, setup 1, to 0.1 Hz
  for (int i = 0; i < 5; ++i) EXPECT_NEAR(hertz[i + 1], printed[i], 0.05);
}

TEST(DistributedInertia, NeedsARunThatCanBeCutOut) {
  Plan output_inside = LumpedPlan();
  output_inside.root["output"]["T_2"] = Value{{"of", "plant.k2.torque"}};
  Plan second_exit = LumpedPlan();
  second_exit.root["plant"]["shaft"]["k5"] = Shaft("I1", "I5", 1e6, 0.0);
  Plan torque_across = LumpedPlan();
  torque_across.root["plant"]["torque"]["T_airgap"]["on"] = Value(Value::Array{"I3", "I4"});
  Plan nonlinear = LumpedPlan();
  nonlinear.root["plant"]["shaft"]["k2"]["law"] = Value("cubic_spring");
  Plan name_taken = LumpedPlan();
  name_taken.root["plant"]["run"] = Value{{"I5", Value{{"inertias", Value::Array{"I1", "I2", "I3"}}}}};
  Plan exit_inside = LumpedPlan();
  exit_inside.root["plant"]["run"]["R"]["inertias"] = Value(Value::Array{"I1", "I3", "I2"});
  for (const Plan& plan : {output_inside, second_exit, torque_across, nonlinear, name_taken, exit_inside}) {
    EXPECT_TRUE(PlacesOf("distributed_inertia", plan).empty());
  }
}

TEST(SeriesElasticity, SitsWhereSomethingIsOnBothSides) {
  // I1: shaft and torque; I2, I3, I4: two shafts; I5: the free end of the line.
  EXPECT_THAT(PlacesOf("series_elasticity", LumpedPlan()),
              ElementsAre("inertia:I1", "inertia:I2", "inertia:I3", "inertia:I4"));
}

TEST(SeriesElasticity, SplitsTheInertiaInTwoHalves) {
  Plan plan = LumpedPlan();
  Apply("series_elasticity", "inertia:I2", {1e7, 3.0}, plan);
  EXPECT_THAT(KeysOf(*plan.root.FindPath("plant.inertia")), ElementsAre("I1", "I2", "I2_b", "I3", "I4", "I5"));
  EXPECT_THAT(KeysOf(*plan.root.FindPath("plant.shaft")), ElementsAre("k1", "series_I2", "k2", "k3", "k4"));
  EXPECT_DOUBLE_EQ(NumberAt(plan, "plant.inertia.I2"), 3.176);
  EXPECT_DOUBLE_EQ(NumberAt(plan, "plant.inertia.I2_b"), 3.176);
  EXPECT_EQ(TextAt(plan, "plant.shaft.k1.between.1"), "I2");
  EXPECT_EQ(TextAt(plan, "plant.shaft.k2.between.0"), "I2_b");
  EXPECT_EQ(NumberAt(plan, "plant.shaft.series_I2.damping_Nms_per_rad"), 3.0);
  EXPECT_EQ(TextAt(plan, "plant.run.R.inertias.2"), "I2_b");
}

TEST(SeriesElasticity, PutsTheTorqueOnOneSideAndTheOnlyShaftOnTheOther) {
  Plan plan = LumpedPlan();
  Apply("series_elasticity", "inertia:I1", {1e7, 3.0}, plan);
  EXPECT_EQ(TextAt(plan, "plant.torque.T_airgap.on"), "I1");
  EXPECT_EQ(TextAt(plan, "plant.shaft.k1.between.0"), "I1_b");
}

TEST(SeriesElasticity, IsTheNominalLineWhenTheJointIsRigid) {
  const Eigen::VectorXd nominal = FrequenciesOf(LumpedPlan());
  for (const char* at : {"inertia:I1", "inertia:I2", "inertia:I4"}) {
    Plan plan = LumpedPlan();
    Apply("series_elasticity", at, {1e10, 0.0}, plan);
    const Eigen::VectorXd split = FrequenciesOf(plan);
    // First order in the compliance: d(nu)/nu = -T^2 / (4 k E) with T the torque in the joint, at most k_shaft/k / 2
    // = 0.3 % for the stiffest shaft, 6e7 N m/rad.
    for (int i = 1; i < 5; ++i) EXPECT_NEAR(split[i], nominal[i], 3e-3 * nominal[i]) << at << " mode " << i;
    Apply("series_elasticity", "inertia:I3", {1e6, 0.0}, plan);
    EXPECT_LT(FrequenciesOf(plan)[1], 0.95 * nominal[1]) << "a soft joint must show";
  }
}

TEST(SeriesElasticity, KeepsTheShareOfATorqueOnSeveralBodies) {
  Plan plan = LumpedPlan();
  plan.root["plant"]["torque"]["T_airgap"]["on"] = Value(Value::Array{"I1", "I2"});
  Apply("series_elasticity", "inertia:I1", {1e8, 0.0}, plan);
  std::vector<std::string> on;
  for (const Value& item : plan.root.FindPath("plant.torque.T_airgap.on")->array()) on.push_back(item.string());
  EXPECT_THAT(on, ElementsAre("I1", "I1_b", "I2"));
}

TEST(CubicStiffness, KeepsTheLinearPart) {
  Plan plan = LumpedPlan();
  Apply("cubic_stiffness", "shaft:k4", {1e9}, plan);
  const auto law = testing::BuildLaw(*plan.root.FindPath("plant.shaft.k4"));
  ASSERT_NE(law, nullptr);
  EXPECT_EQ(law->linear().stiffness, 6.28e6);
  EXPECT_DOUBLE_EQ(law->Torque({0.0, 2e-3, 0.0, 0.0, {}, {}}), 6.28e6 * 2e-3 + 1e9 * 8e-9);
  EXPECT_THAT(PlacesOf("cubic_stiffness", plan), ElementsAre("shaft:k1", "shaft:k2", "shaft:k3"));
}

TEST(StageEffects, ActuatorsAppendAndSensorsStayBeforeTheNoise) {
  Plan plan = LumpedPlan();
  Apply("actuator_lag", "input:T_airgap", {1e-3}, plan);
  Apply("sensor_gain", "output:T_shaft", {1.1}, plan);
  Apply("sensor_offset", "output:omega_1", {0.5}, plan);
  EXPECT_EQ(TextAt(plan, "input.T_airgap.actuator.1.type"), "first_order_lag");
  EXPECT_EQ(NumberAt(plan, "input.T_airgap.actuator.1.tau_s"), 1e-3);
  EXPECT_EQ(NumberAt(plan, "output.T_shaft.sensor.1.gain"), 1.1);
  EXPECT_EQ(TextAt(plan, "output.T_shaft.sensor.2.type"), "noise");
  EXPECT_EQ(NumberAt(plan, "output.omega_1.sensor.0.offset"), 0.5);
}

TEST(StageEffects, AStageWithoutBracketsBecomesAList) {
  Plan plan = LumpedPlan();
  plan.root["input"]["T_airgap"]["actuator"] = Value{{"type", "gain"}, {"gain", 2.0}};
  Apply("actuator_delay", "input:T_airgap", {2e-4}, plan);
  EXPECT_EQ(NumberAt(plan, "input.T_airgap.actuator.0.gain"), 2.0);
  EXPECT_EQ(NumberAt(plan, "input.T_airgap.actuator.1.delay_s"), 2e-4);
}

}  // namespace
}  // namespace dynoproof
