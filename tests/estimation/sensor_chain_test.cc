// A sensor's own error comes off before a sample corrects a state.
#include "estimation/sensor_chain.h"

#include <gtest/gtest.h>

#include <cmath>
#include <optional>
#include <utility>
#include <vector>

#include "estimation/predictor.h"
#include "tests/estimation/four_masses.h"
#include "tests/estimation/made_record.h"

namespace dynoproof::estimation {
namespace {

const std::vector<std::string> kOutputs = {"T_shaft", "omega_1"};

TEST(SensorChain, IsToldByItsStages) {
  Plan plan = FourMasses(0.1);
  plan.root["output"]["T_shaft"]["sensor"] =
      Value(Value::Array{Value{{"type", "gain"}, {"gain", -2.0}}, Value{{"type", "first_order_lag"}, {"tau_s", 1e-3}},
                         Value{{"type", "delay"}, {"delay_s", 2.5e-4}}, Value{{"type", "offset"}, {"offset", 7.0}},
                         Value{{"type", "first_order_lag"}, {"tau_s", 5e-4}}});
  plan.root["output"]["omega_1"]["sensor"] = Value(Value::Array{Value{{"type", "rectified"}}});
  const std::unique_ptr<Rig> rig = testing::RigOf(plan);
  const auto output = [&](const char* name) {
    return static_cast<std::size_t>(std::ranges::find(rig->outputs, name, &OutputLine::name) - rig->outputs.begin());
  };
  Frame frame = rig->MakeFrame();
  const SensorChain torque(*rig, output("T_shaft"));
  EXPECT_NEAR(torque.SlopeAt(frame, 0.0), -2.0, 1e-9);
  EXPECT_NEAR(torque.lag_s(), 1.5e-3, 1e-12);
  EXPECT_NEAR(torque.delay_s(), 2.5e-4, 1e-12);
  const SensorChain speed(*rig, output("omega_1"));
  for (const double value : {3.0, -3.0}) {
    frame.signals[static_cast<std::size_t>(rig->FindSlot("plant.I1.speed"))] = value;
    EXPECT_NEAR(speed.SlopeAt(frame, 0.0), std::copysign(1.0, value), 1e-9);
  }
  const SensorChain none(*rig, output("omega_4"));
  EXPECT_EQ(none.SlopeAt(frame, 0.0), 1.0);
}

TEST(SensorChain, ALagIsUndone) {
  constexpr double kPeriod = 1e-4, kLag = 7e-4;
  LagInverse inverse(kLag);
  const double kept = KeptOver(kPeriod, kLag);
  double lagged = 0.3;
  for (int k = 0; k < 200; ++k) {
    const double in = 0.3 + std::sin(0.05 * k);
    lagged = k == 0 ? in : kept * lagged + (1.0 - kept) * in;
    EXPECT_NEAR(inverse(lagged, kPeriod), in, 1e-12);
  }
}

struct Sensor {
  const char* effect;
  const char* at;
  std::vector<double> truth;
};
const std::vector<Sensor> kSensors = {
    {"sensor_gain", "output:T_shaft", {1.3}},     {"sensor_gain", "output:omega_1", {0.8}},
    {"sensor_lag", "output:T_shaft", {3e-4}},     {"sensor_lag", "output:omega_1", {2e-3}},
    {"sensor_delay", "output:T_shaft", {3e-4}},   {"sensor_delay", "output:T_shaft", {2.6e-4}},
    {"sensor_delay", "output:omega_1", {7.5e-4}}, {"sensor_offset", "output:T_shaft", {4.0}},
    {"sensor_drift", "output:omega_1", {0.5}},
};

/// RMS of the innovations of a model, by channel, over what noise alone causes. `plan`: whose observer corrects it.
std::vector<double> SizesOf(const Plan& truth, const Plan& plan, const DataSet& data, double memory_s) {
  const Result<LinearModel> model = LinearModel::Of(plan, data.records().front(), testing::BuiltIns());
  EXPECT_TRUE(model.ok());
  const Predictor predictor(data, *model, testing::BuiltIns(), memory_s, nullptr);
  const Result<Prediction> there = predictor.Predict(truth);
  EXPECT_TRUE(there.ok()) << memory_s << ": " << there.failure().ToString();
  if (!there.ok()) return {};
  std::vector<double> sizes;
  for (std::size_t c = 0; c < data.channels().size(); ++c) {
    const Channel& channel = data.channels()[c];
    const std::span rows(there->innovations.data() + channel.begin, static_cast<std::size_t>(channel.count));
    sizes.push_back(score::RootMeanSquare(rows) / there->noise_alone[static_cast<Eigen::Index>(c)]);
  }
  return sizes;
}

/// Of the model with the sensor.
std::vector<double> Sizes(const Sensor& sensor, double noise, double memory_s) {
  const Plan plan = FourMasses(1.0), truth = WithEffect(plan, sensor.effect, sensor.at, sensor.truth);
  return SizesOf(truth, plan, DataSet({RecordOf(truth, noise, kOutputs)}, plan, {.from_s = 0.2}), memory_s);
}

TEST(SensorChain, OfTheRightModelNothingIsLeftButNoise) {
  for (const Sensor& sensor : kSensors) {
    for (const double memory_s : {0.005, 0.025, 0.25}) {
      // A lag tells of a signal half a sample late: modes of 1.4 kHz do not bear a correction as strong as that.
      if (std::string(sensor.effect) == "sensor_lag" && memory_s < 0.02) continue;
      for (const double size : Sizes(sensor, 0.005, memory_s))
        EXPECT_NEAR(size, 1.0, 0.1) << sensor.effect << " " << sensor.at << " " << memory_s;
    }
  }
}

/// A tick gives a new command, and a sample is of before: where the model is right, the command that an output shows is, too.
TEST(SensorChain, WhatATickChangesIsShownAsItWasBefore) {
  Plan plan = FourMasses(0.5);
  plan.root["output"]["shown"] = Value{{"of", "input.T"}, {"nominal", 100.0}};
  const DataSet data({RecordOf(plan, 0.0, {"T_shaft", "shown"})}, plan, {.from_s = 0.1});
  const Result<LinearModel> model = LinearModel::Of(plan, data.records().front(), testing::BuiltIns());
  ASSERT_TRUE(model.ok());
  for (const std::optional<double> memory_s : {std::optional(0.025), std::optional<double>()}) {
    const Predictor predictor(data, *model, testing::BuiltIns(), memory_s, nullptr);
    const Result<Prediction> there = predictor.Predict(plan);
    ASSERT_TRUE(there.ok()) << there.failure().ToString();
    for (const Channel& channel : data.channels()) {
      EXPECT_GT(channel.spread, 1.0) << channel.name;
      EXPECT_LT(there->innovations.segment(channel.begin, channel.count).cwiseAbs().maxCoeff(), 1e-6) << channel.name;
    }
  }
}

TEST(SensorChain, ADelayBetweenTicksKeepsASoftRotorStable) {
  // 70 masses have modes far above half the sampling rate: whoever corrects them by what they were between two ticks drives them.
  const Plan plan = Scenario("scenarios/diagnose/heavy_duty_soft.toml", {"run.duration_s=0.5"}),
             truth = WithEffect(plan, "sensor_delay", "output:T_shaft", {2.6e-4});
  const DataSet data({RecordOf(truth, 0.01, kOutputs)}, plan, {.from_s = 0.1});
  for (const double memory_s : {0.01, 0.1}) {
    const std::vector<double> sizes = SizesOf(truth, plan, data, memory_s);
    ASSERT_EQ(sizes.size(), data.channels().size());
    for (std::size_t c = 0; c < sizes.size(); ++c)
      EXPECT_LT(sizes[c], 1.1) << data.channels()[c].name << " " << memory_s;
  }
}

/// The angle of a line that turns is a million times as large as its twists. Rounding in its covariance once cut a mode's pair of states in
/// two, and the observer's gains then drove that mode.
TEST(SensorChain, AnAngleBesideATorqueKeepsASoftRotorStable) {
  const Plan plan =
      Scenario("scenarios/diagnose/r2r_soft.toml", {"run.duration_s=3", "plant.rotor.I1.inertia_kg_m2=4.57"});
  const DataSet data({RecordOf(plan, 1e-3, {"T_shaft", "omega_1", "phi_1"})}, plan, {.from_s = 0.1});
  for (const double memory_s : {0.001, 0.003, 0.01}) {
    const std::vector<double> sizes = SizesOf(plan, plan, data, memory_s);
    ASSERT_EQ(sizes.size(), data.channels().size());
    for (std::size_t c = 0; c < sizes.size(); ++c)
      EXPECT_LT(sizes[c], 1.1) << data.channels()[c].name << " " << memory_s;
  }
}

TEST(SensorChain, GainAndMassDoNotBuyAnObserver) {
  // Output and inertias scaled alike are the same machine seen otherwise: the same innovations over the gain.
  const Plan plan = FourMasses(0.5);
  const DataSet data({RecordOf(plan, 0.005, {"omega_1"})}, plan);
  const Result<LinearModel> model = LinearModel::Of(plan, data.records().front(), testing::BuiltIns());
  ASSERT_TRUE(model.ok());
  const Predictor predictor(data, *model, testing::BuiltIns(), 0.025, nullptr);
  Plan heavy = WithEffect(plan, "sensor_gain", "output:omega_1", {10.0});
  for (auto& entry : heavy.root["plant"]["inertia"].table()) entry.value = Value(10.0 * entry.value.number());
  for (auto& entry : heavy.root["plant"]["shaft"].table()) {
    for (const char* key : {"stiffness_Nm_per_rad", "damping_Nms_per_rad"})
      entry.value[key] = Value(10.0 * entry.value[key].number());
  }
  const Result<Eigen::VectorXd> light = predictor.Innovations(plan), same = predictor.Innovations(heavy);
  ASSERT_TRUE(light.ok() && same.ok());
  EXPECT_LT((*light - *same).cwiseAbs().maxCoeff(), 1e-6 * light->cwiseAbs().maxCoeff());
}

}  // namespace
}  // namespace dynoproof::estimation
