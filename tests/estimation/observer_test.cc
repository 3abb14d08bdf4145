#include "estimation/observer.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "estimation/predictor.h"
#include "experiment/drive_by_record.h"
#include "tests/estimation/four_masses.h"
#include "tests/estimation/made_record.h"

namespace dynoproof::estimation {
namespace {

using ::testing::ElementsAre;

Plan SwungMass() {
  return testing::OneMass(2.0,
                          Value{{"type", "sine_sum"},
                                {"amplitudes", Value::Array{5.0}},
                                {"frequencies_Hz", Value::Array{7.0}},
                                {"phases_rad", Value::Array{0.0}}},
                          1.0);
}

/// A mass under a torque, its speed recorded with noise.
struct Mass {
  Plan plan = SwungMass();
  DataSet data{{RecordOf(plan, 0.01, {"w"})}, plan};
};

TEST(LinearModel, OfAMassIsItsSpeed) {
  const Mass mass;
  ASSERT_EQ(mass.data.channels().size(), 1U);
  const Result<LinearModel> model = LinearModel::Of(mass.plan, mass.data.records().front(), testing::BuiltIns());
  ASSERT_TRUE(model.ok()) << model.failure().ToString();
  ASSERT_EQ(model->part.basis.cols(), 1);  // the angle is not seen
  EXPECT_NEAR(model->regimes.front().A(0, 0), 1.0, 1e-12);
  const double moved = model->regimes.front().C.row(0) * model->regimes.front().G.col(1);
  EXPECT_NEAR(std::abs(moved), 1e-4 / 2.0 * 5.0 / std::sqrt(2.0), 1e-8);  // T h / I of the input's RMS
}

/// The backlash bed under an air-gap torque by period, two seconds from the middle of its gap.
MappedRecord DrivenBy(const std::function<double(int)>& torque_Nm) {
  std::vector<double> time, drives, rests;
  for (int i = 0; i <= 20'000; ++i) {
    time.push_back(1e-4 * i);
    drives.push_back(torque_Nm(i));
    rests.push_back(0.0);
  }
  const auto shared = [](std::vector<double> values) {
    return std::make_shared<const std::vector<double>>(std::move(values));
  };
  MappedRecord record;
  const auto clock = shared(time);
  record.inputs["T_1"] = {clock, shared(drives)};
  record.inputs["T_2"] = {clock, shared(rests)};
  record.outputs["omega_1"] = record.outputs["omega_2"] = record.outputs["T_m1"] = {clock, shared(rests)};
  record.end_s = time.back();
  return record;
}

Plan BacklashBed() { return Scenario("scenarios/diagnose/backlash.toml", {"run.duration_s=2"}); }

// The other flank is a regime of its own, however seldom it is looked at. Without it the record corrects the run there as it does within the
// gap, and what noise causes grows by half.
TEST(LinearModel, KnowsEveryFlankOfAGapThatARunTouches) {
  // It rests on one flank; a pulse takes it to the other for some milliseconds, between two of the looks at the run.
  const MappedRecord record = DrivenBy([](int i) {
    return i < 10'000 || i >= 10'300 ? -1.0 : i < 10'145 ? 100.0 : -100.0;
  });
  const Result<LinearModel> model = LinearModel::Of(BacklashBed(), record, testing::BuiltIns());
  ASSERT_TRUE(model.ok()) << model.failure().ToString();
  std::vector<std::vector<int>> modes;
  for (const LinearModel::Regime& regime : model->regimes) modes.push_back(regime.modes);
  EXPECT_THAT(modes, ElementsAre(ElementsAre(1), ElementsAre(0), ElementsAre(-1)));
}

TEST(Observer, CorrectsOnAFlankThatTheModelNeverTouchedAsOnTheOther) {
  const Plan plan = BacklashBed();
  const MappedRecord record = DrivenBy([](int i) { return i < 12'000 ? 0.0 : -1.0; });  // longer within the gap
  const Result<LinearModel> model = LinearModel::Of(plan, record, testing::BuiltIns());
  ASSERT_TRUE(model.ok()) << model.failure().ToString();
  ASSERT_EQ(model->regimes.size(), 2U);
  const Observer observer(*model, Eigen::VectorXd::Constant(3, 0.01), 1e-4, 0.01);
  const Result<BuiltRun> run = BuildRun(plan, record, testing::BuiltIns());
  ASSERT_TRUE(run.ok());
  EXPECT_EQ(observer.GainsFor(*run->rig, {-1}), observer.GainsFor(*run->rig, {1}));
  EXPECT_NE(observer.GainsFor(*run->rig, {-1}), observer.GainsFor(*run->rig, {0}));
}

TEST(Observer, OfAMassForgetsWithItsMemory) {
  const Mass mass;
  const Result<LinearModel> model = LinearModel::Of(mass.plan, mass.data.records().front(), testing::BuiltIns());
  ASSERT_TRUE(model.ok());
  const Eigen::VectorXd noise = Eigen::VectorXd::Constant(1, mass.data.channels().front().noise);
  const Observer observer(*model, noise, 1e-4, 0.02);
  EXPECT_NEAR(observer.memory_s(), 0.02, 2e-4);
  // One state: 1 - K = exp(-h / memory); what white noise causes in y - x: sigma^2 (1 + K / (2 - K)).
  const double gain = 1.0 - std::exp(-1e-4 / observer.memory_s());
  EXPECT_NEAR(observer.NoiseAlone(*model, noise)[0], noise[0] * std::sqrt(1.0 + gain / (2.0 - gain)), 1e-9 * noise[0]);
  const Result<BuiltRun> run = BuildRun(mass.plan, mass.data.records().front(), testing::BuiltIns());
  ASSERT_TRUE(run.ok());
  const auto gains = observer.GainsFor(*run->rig, {});
  for (std::size_t i = 0; i < run->rig->state_ports.size(); ++i) {
    const bool speed = run->rig->state_ports[i].name.ends_with("speed");
    EXPECT_NEAR(gains[0][i], speed ? gain : 0.0, 1e-9) << run->rig->state_ports[i].name;
  }
}

// A pendulum's spring is tied to a wall, which is a body of a thousand tons: it stands still whatever acts on it, and no gain moves it.
TEST(Observer, OfABodyTiedToAWallForgetsWithItsMemoryToo) {
  Plan plan = SwungMass();
  WriteNumber(plan.root, "plant.inertia.wall", 1e6);
  plan.root["plant"]["shaft"]["spring"] =
      Value{{"between", Value::Array{"I", "wall"}}, {"stiffness_Nm_per_rad", 800.0}, {"damping_Nms_per_rad", 1.0}};
  const DataSet data({RecordOf(plan, 0.01, {"phi"})}, plan);
  const Result<LinearModel> model = LinearModel::Of(plan, data.records().front(), testing::BuiltIns());
  ASSERT_TRUE(model.ok()) << model.failure().ToString();
  const Eigen::VectorXd noise = Eigen::VectorXd::Constant(1, data.channels().front().noise);
  for (const double memory_s : {0.03, 0.1})
    EXPECT_NEAR(Observer(*model, noise, 1e-4, memory_s).memory_s(), memory_s, 0.02 * memory_s);
}

TEST(MemoryFor, ALinesCommonSpeedIsNoModeHoweverItIsRounded) {
  const Plan plan = FourMasses(1.2);
  const DataSet data({RecordOf(plan, 0.01, {"T_shaft", "omega_1"})}, plan);
  Result<LinearModel> model = LinearModel::Of(plan, data.records().front(), testing::BuiltIns());
  ASSERT_TRUE(model.ok());
  const Eigen::MatrixXd A = model->regimes.front().A;
  for (const double rounded : {1.0 - 1e-15, 1.0, 1.0 + 1e-15}) {
    model->regimes.front().A = rounded * A;
    // Fifteen periods of the slowest mode, 15 ms each or less. As a mode of infinite period it took a tenth of the record.
    EXPECT_LT(MemoryFor(*model, 10.0), 0.3) << rounded;
  }
}

struct OutputsAndMemories {
  std::vector<std::string> outputs;
  std::vector<double> memories_s;
};
class ObserverOfALine : public ::testing::TestWithParam<OutputsAndMemories> {};

TEST_P(ObserverOfALine, ReachesItsMemory) {
  const Plan plan = FourMasses(0.5);
  const DataSet data({RecordOf(plan, 0.005, GetParam().outputs)}, plan);
  const Result<LinearModel> model = LinearModel::Of(plan, data.records().front(), testing::BuiltIns());
  ASSERT_TRUE(model.ok());
  for (const double memory_s : GetParam().memories_s) {
    const Predictor predictor(data, *model, testing::BuiltIns(), memory_s, nullptr);
    ASSERT_TRUE(predictor.observer().has_value());
    EXPECT_NEAR(predictor.observer()->memory_s() / memory_s, 1.0, 0.05);
    // Of the right model nothing is left but what noise causes.
    const Result<Prediction> there = predictor.Predict(plan);
    ASSERT_TRUE(there.ok());
    for (std::size_t c = 0; c < data.channels().size(); ++c) {
      const Channel& channel = data.channels()[c];
      const double rms = std::sqrt(there->innovations.segment(channel.begin, channel.count).squaredNorm() /
                                   static_cast<double>(channel.count));
      EXPECT_NEAR(rms / there->noise_alone[static_cast<Eigen::Index>(c)], 1.0, 0.05) << channel.name << " " << memory_s;
    }
  }
}

// Where a torque alone is measured no output sees the common speed, which no gain can make forget. That torque tells of the first
// masses within some 20 ms at the soonest, and by itself the line forgets in 90 ms.
INSTANTIATE_TEST_SUITE_P(Outputs, ObserverOfALine,
                         ::testing::Values(OutputsAndMemories{{"T_shaft", "omega_1"}, {0.005, 0.025, 0.25}},
                                           OutputsAndMemories{{"T_shaft"}, {0.025, 0.05}}),
                         [](const auto& tested) { return tested.index == 0 ? "TorqueAndSpeed" : "TorqueAlone"; });

}  // namespace
}  // namespace dynoproof::estimation
