#include "estimation/observer.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "estimation/estimator.h"
#include "estimation/predictor.h"
#include "experiment/drive_by_record.h"
#include "tests/estimation/four_masses.h"
#include "tests/estimation/made_record.h"

namespace dynoproof::estimation {
namespace {

/// A mass under a torque, its speed recorded with noise.
struct Mass {
  Plan plan = testing::OneMass(2.0,
                               Value{{"type", "sine_sum"},
                                     {"amplitudes", Value::Array{5.0}},
                                     {"frequencies_Hz", Value::Array{7.0}},
                                     {"phases_rad", Value::Array{0.0}}},
                               1.0);
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

TEST(Observer, ReachesItsMemoryOnALine) {
  const Plan plan = FourMasses(0.5);
  const DataSet data({RecordOf(plan, 0.005, {"T_shaft", "omega_1"})}, plan);
  const Result<LinearModel> model = LinearModel::Of(plan, data.records().front(), testing::BuiltIns());
  ASSERT_TRUE(model.ok());
  for (const double memory_s : {0.005, 0.025, 0.25}) {
    const Predictor predictor(data, *model, testing::BuiltIns(), memory_s, nullptr);
    ASSERT_TRUE(predictor.observer().has_value());
    EXPECT_NEAR(predictor.observer()->memory_s() / memory_s, 1.0, 0.05);
    // Of the right model nothing is left but what noise causes.
    const Result<Eigen::VectorXd> rows = predictor.Innovations(plan);
    ASSERT_TRUE(rows.ok());
    const Eigen::VectorXd alone = predictor.NoiseAlone(plan);
    for (std::size_t c = 0; c < data.channels().size(); ++c) {
      const Channel& channel = data.channels()[c];
      const double rms =
          std::sqrt(rows->segment(channel.begin, channel.count).squaredNorm() / static_cast<double>(channel.count));
      EXPECT_NEAR(rms / alone[static_cast<Eigen::Index>(c)], 1.0, 0.05) << channel.name << " " << memory_s;
    }
  }
}

TEST(Predictor, WithoutCorrectionIsTheFreeRun) {
  const Plan plan = FourMasses(0.2);
  const MappedRecord record = RecordOf(plan, 0.0, {"T_shaft", "omega_1"});
  const DataSet data({record}, plan);
  const Result<LinearModel> model = LinearModel::Of(plan, data.records().front(), testing::BuiltIns());
  ASSERT_TRUE(model.ok());
  const Predictor free(data, *model, testing::BuiltIns(), std::nullopt, nullptr);
  const Result<Eigen::VectorXd> rows = free.Innovations(plan);
  ASSERT_TRUE(rows.ok());
  EXPECT_EQ(rows->cwiseAbs().maxCoeff(), 0.0);
}

TEST(Predictor, ALedRunHasForgottenWhereItStarted) {
  const Plan plan = FourMasses(0.3);
  Plan moving = plan;
  moving.root["plant"]["initial_speed_rad_per_s"] = Value(3.0);
  const DataSet data({RecordOf(moving, 0.0, {"T_shaft", "omega_1"})}, plan, {.from_s = 0.2});
  const Result<LinearModel> model = LinearModel::Of(plan, data.records().front(), testing::BuiltIns());
  ASSERT_TRUE(model.ok());
  const Predictor strong(data, *model, testing::BuiltIns(), 0.01, nullptr);
  const Predictor free(data, *model, testing::BuiltIns(), std::nullopt, nullptr), led(strong, 0.2, std::nullopt),
      in_steps(Predictor(strong, 0.1, 0.03), 0.2, std::nullopt), weak(strong, 0.2, 10.0);
  const auto speed_off = [&](const Predictor& predictor) {
    const Channel& speed = *std::ranges::find(data.channels(), "omega_1", &Channel::name);
    return predictor.Innovations(plan)->segment(speed.begin, speed.count).cwiseAbs().maxCoeff();
  };
  EXPECT_NEAR(speed_off(free), 3.0, 1e-9);
  for (const Predictor* one : {&led, &in_steps, &weak}) {
    EXPECT_LT(speed_off(*one), 1e-3);  // e^-20 of it, and what the slower modes still know
    EXPECT_EQ(one->free_run(), one != &weak);
  }
}

TEST(Hypothesis, TheStartOfARecordIsAParameter) {
  Plan plan = FourMasses(0.3);
  Plan moving = plan;
  moving.root["plant"]["initial_speed_rad_per_s"] = Value(3.0);
  EXPECT_TRUE(Hypothesis(plan).WithStartFree(0, testing::BuiltIns()).parameters().empty()) << "none in the plan";
  plan.root["of_record"]["0"]["start"]["plant"]["initial_speed_rad_per_s"] = Value(2.5);
  const Hypothesis hypothesis = Hypothesis(plan).WithStartFree(0, testing::BuiltIns());
  ASSERT_EQ(hypothesis.parameters().size(), 1u);
  const DataSet data({RecordOf(moving, 0.01, {"T_shaft", "omega_1"})}, plan);
  const Result<LinearModel> model = LinearModel::Of(StartingInto(plan, 0), data.records().front(), testing::BuiltIns());
  ASSERT_TRUE(model.ok());
  const Predictor free(data, *model, testing::BuiltIns(), std::nullopt, nullptr);
  const Estimate fit = Fit(hypothesis, free, hypothesis.start());
  ASSERT_TRUE(fit.ok()) << fit.broken;
  const double deviation = std::sqrt(Sandwich(fit, data, hypothesis)(0, 0)) * hypothesis.parameters()[0].scale;
  EXPECT_NEAR(hypothesis.parameters()[0].ValueAt(fit.q[0]), 3.0, 4.0 * deviation);
  EXPECT_LT(deviation, 0.01);
}

TEST(Predictor, OfALinearModelIsAKalmanFilter) {
  const Plan plan = FourMasses(0.3), off = WithEffect(plan, "stiffness_change", "shaft:k2", {0.05});
  const DataSet data({RecordOf(off, 0.005, {"T_shaft", "omega_1"})}, plan);
  const MappedRecord& record = data.records().front();
  const Result<LinearModel> model = LinearModel::Of(plan, record, testing::BuiltIns());
  ASSERT_TRUE(model.ok());
  const Predictor predictor(data, *model, testing::BuiltIns(), 0.025, nullptr);
  const Result<Eigen::VectorXd> rows = predictor.Innovations(plan);
  ASSERT_TRUE(rows.ok());
  // The filter by matrices: x+ = A (x + K e) + B u, with the reduced model of the same plan; the input is its last force.
  const LinearModel::Regime& m = model->regimes.front();
  const double leak = std::exp(-1e-4 / (1e3 * 0.025));  // nothing is remembered for longer than a thousand memories
  const Eigen::MatrixXd K = mechanics::MakeStationaryFilter(
                                leak * m.A, m.C, std::pow(predictor.observer()->share(), 2) * m.G * m.G.transpose(),
                                Eigen::Vector2d(data.channels()[0].noise, data.channels()[1].noise).cwiseAbs2())
                                .gain;
  const std::vector<double>& torque = *record.inputs.at("T").values;
  const double usual = score::RootMeanSquare(torque);
  Eigen::VectorXd x = Eigen::VectorXd::Zero(m.A.rows());
  double largest = 0.0, scale = 0.0;
  for (std::size_t k = 0; k < torque.size(); ++k) {
    const auto row = static_cast<Eigen::Index>(k);
    const Eigen::Vector2d y(data.measured()[row], data.measured()[data.channels()[1].begin + row]);
    const Eigen::Vector2d e = y - m.C * x;
    largest = std::max(largest, std::abs(e[0] - (*rows)[row]));
    scale = std::max(scale, std::abs(e[0]));
    x = (m.A * (x + K * e) + m.G.col(m.G.cols() - 1) * torque[k] / usual).eval();
  }
  EXPECT_LT(largest, 1e-6 * scale);  // the reduction leaves out what is seen by less than a millionth
}

}  // namespace
}  // namespace dynoproof::estimation
