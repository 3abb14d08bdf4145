#include "estimation/predictor.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "linear/discrete_equations.h"
#include "tests/estimation/four_masses.h"
#include "tests/estimation/made_record.h"

namespace dynoproof::estimation {
namespace {

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

/// By a free run nothing is corrected; a corrected one follows samples that are off, and is off by that beside the record's own.
TEST(Predictor, IsCorrectedByOtherSamples) {
  const Plan plan = FourMasses(0.2);
  const DataSet data({RecordOf(plan, 0.0, {"T_shaft", "omega_1"})}, plan);
  const Result<LinearModel> model = LinearModel::Of(plan, data.records().front(), testing::BuiltIns());
  ASSERT_TRUE(model.ok());
  const Predictor free(data, *model, testing::BuiltIns(), std::nullopt, nullptr),
      corrected(data, *model, testing::BuiltIns(), 0.01, nullptr);
  const auto faster = [](MappedRecord& record, std::size_t) {
    Series& speed = record.outputs.at("omega_1");
    std::vector<double> values = *speed.values;
    for (double& value : values) value += 0.5;
    speed.values = std::make_shared<const std::vector<double>>(std::move(values));
  };
  EXPECT_EQ(free.CorrectedByOthers(plan, faster)->cwiseAbs().maxCoeff(), 0.0);
  EXPECT_EQ(*corrected.CorrectedByOthers(plan, [](MappedRecord&, std::size_t) {}), *corrected.Innovations(plan));
  const Channel& speed = *std::ranges::find(data.channels(), "omega_1", &Channel::name);
  const Eigen::VectorXd rows = *corrected.CorrectedByOthers(plan, faster);
  EXPECT_NEAR(rows.segment(speed.begin, speed.count).tail(speed.count / 2).mean(), -0.5, 0.05);
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

// A record whose stamps lie between the ticks of the plan is compared there, corrected or not.
// Corrected on one half alone the run of the first was 7 % off, and that of the other diverged.
TEST(Predictor, HalvesOfAMassOnAStiffJointAreCorrectedAsTheWholeIs) {
  const Plan plan = FourMasses(0.3), off = WithEffect(plan, "stiffness_change", "shaft:k2", {0.05});
  const DataSet data({RecordOf(off, 0.005, {"T_shaft", "omega_1"})}, plan);
  const Result<LinearModel> model = LinearModel::Of(plan, data.records().front(), testing::BuiltIns());
  ASSERT_TRUE(model.ok());
  const Predictor predictor(data, *model, testing::BuiltIns(), 0.01, nullptr);
  const Result<Eigen::VectorXd> whole = predictor.Innovations(plan);
  ASSERT_TRUE(whole.ok());
  for (const std::string mass : {"I2", "I3"}) {
    const Result<Eigen::VectorXd> halves =
        predictor.Innovations(WithEffect(plan, "series_elasticity", "inertia:" + mass, {1e12, 1e5}));
    ASSERT_TRUE(halves.ok());
    EXPECT_LT((*halves - *whole).norm(), 0.01 * whole->norm()) << mass;
  }
}

// A friction has a mode of its own, slipping or not. Where that counted as one of the gap's, the run was corrected throughout by the gains of
// the most visited state of the gap: the true model left four times the noise, and ten times over a longer memory.
TEST(Predictor, AFrictionBesidePlayLeavesTheGapItsGains) {
  const Plan plan = Scenario("scenarios/diagnose/backlash.toml", {"run.duration_s=0.5"});
  const DataSet data({RecordOf(plan, 0.01, {"omega_1", "omega_2", "omega_3"})}, plan);
  const Result<LinearModel> model = LinearModel::Of(plan, data.records().front(), testing::BuiltIns());
  ASSERT_TRUE(model.ok());
  ASSERT_GT(model->regimes.size(), 1U);
  const Predictor predictor(data, *model, testing::BuiltIns(), 0.01, nullptr);
  const Result<Eigen::VectorXd> without = predictor.Innovations(plan);
  const Result<Eigen::VectorXd> with = predictor.Innovations(WithEffect(plan, "coulomb_friction", "inertia:I6", {0.0}));
  ASSERT_TRUE(without.ok() && with.ok());
  EXPECT_LT((*with - *without).norm(), 1e-3 * without->norm());
}

TEST(Predictor, ARecordBetweenTicksIsComparedWhereItIs) {
  const Plan plan = FourMasses(0.3);
  const MappedRecord made = RecordOf(plan, 0.0, {"omega_1"});
  const std::vector<double>&time = *made.outputs.at("omega_1").time, &values = *made.outputs.at("omega_1").values;
  MappedRecord between = made;
  std::vector<double> halves, middles;
  for (std::size_t i = 1; i + 2 < time.size(); ++i) {
    halves.push_back(0.5 * (time[i] + time[i + 1]));
    middles.push_back((9.0 * (values[i] + values[i + 1]) - values[i - 1] - values[i + 2]) / 16.0);
  }
  between.outputs["omega_1"] = {std::make_shared<const std::vector<double>>(std::move(halves)),
                                std::make_shared<const std::vector<double>>(std::move(middles))};
  const double spread = score::StandardDeviation(values);
  for (const std::optional<double> memory_s : {std::optional<double>(), std::optional(0.02)}) {
    double left[2] = {};
    for (const bool of_halves : {false, true}) {
      const DataSet data({of_halves ? between : made}, plan);
      const Result<LinearModel> model = LinearModel::Of(plan, data.records().front(), testing::BuiltIns());
      ASSERT_TRUE(model.ok());
      const Result<Eigen::VectorXd> rows =
          Predictor(data, *model, testing::BuiltIns(), memory_s, nullptr).Innovations(plan);
      ASSERT_TRUE(rows.ok()) << rows.failure().ToString();
      left[of_halves] = std::sqrt(rows->squaredNorm() / static_cast<double>(rows->size()));
    }
    EXPECT_LT(left[0], 1e-6 * spread);
    EXPECT_LT(left[1], 0.01 * spread);  // what cubics leave of modes up to 1.7 kHz at 10 kHz
  }
}

}  // namespace
}  // namespace dynoproof::estimation
