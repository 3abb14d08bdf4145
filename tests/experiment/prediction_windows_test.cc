// A record of a line with play is predicted in windows: from its past alone, and well where a free run has long lost
// it.
#include "experiment/prediction_windows.h"

#include <gtest/gtest.h>

#include <cmath>

#include "base/random.h"
#include "experiment/prepare.h"
#include "score/series.h"
#include "sim/solver.h"
#include "tests/support/registry.h"

namespace dynoproof {
namespace {

constexpr double kDuration_s = 0.4, kWindow_s = 0.05;

class PredictionWindows : public ::testing::Test {
 protected:
  std::unique_ptr<Prepared> Line(const std::vector<std::string>& changes, const MappedRecord* data = nullptr) {
    PrepareOptions options;
    options.overrides = changes;
    options.data = data;
    Diagnostics diagnostics;
    auto prepared = Prepare("scenarios/diagnose/backlash.toml", options, testing::FullRegistry(), diagnostics);
    EXPECT_NE(prepared, nullptr) << diagnostics.Format();
    return prepared;
  }

  /// What a logger would have written of that machine, by the other solver; noise as a share of each signal's spread.
  MappedRecord Measured(std::vector<std::string> changes, double noise) {
    changes.push_back("run.duration_s=" + std::to_string(kDuration_s));
    const auto prepared = Line(changes);
    const Rig& rig = *prepared->rig;
    const auto solver = MakeReferenceSolver(rig);
    const Result<Samples> samples = Simulate(rig, **solver);
    EXPECT_TRUE(samples.ok());
    MappedRecord record;
    record.end_s = samples->time.back();
    const auto time = std::make_shared<const std::vector<double>>(samples->time);
    const auto share = [](std::vector<double> values) {
      return std::make_shared<const std::vector<double>>(std::move(values));
    };
    for (std::size_t i = 0; i < rig.inputs.size(); ++i)
      record.inputs[rig.inputs[i].name] = {time, share(samples->inputs[i])};
    for (std::size_t i = 0; i < rig.outputs.size(); ++i) {
      std::vector<double> values = samples->outputs[i];
      const double sigma = noise * score::StandardDeviation(values);
      for (std::size_t k = 0; k < values.size(); ++k) values[k] += sigma * RandomNormal(11, i, k);
      record.outputs[rig.outputs[i].name] = {time, share(std::move(values))};
    }
    return record;
  }

  /// omega_1 predicted in windows by the nominal line.
  std::vector<double> Predicted(const MappedRecord& record) {
    const auto prepared = Line({}, &record);
    const Rig& rig = *prepared->rig;
    const Result<Observer> observer = MakeObserver(rig, record, kWindow_s);
    EXPECT_TRUE(observer.ok()) << observer.failure().ToString();
    const auto solver = MakeRealtimeSolver(rig);
    const Result<Samples> samples = PredictInWindows(rig, **solver, *observer);
    EXPECT_TRUE(samples.ok());
    return samples->outputs[0];
  }

  static double Nrmse(const std::vector<double>& measured, const std::vector<double>& predicted, std::size_t from) {
    double square = 0.0;
    for (std::size_t k = from; k < measured.size(); ++k) square += std::pow(measured[k] - predicted[k], 2);
    return std::sqrt(square / static_cast<double>(measured.size() - from)) / score::StandardDeviation(measured);
  }
};

TEST_F(PredictionWindows, FindTheStateWhereAFreeRunHasLostIt) {
  // The machine starts where the model does not know: the twist in the gap is wrong until the sides have met.
  const MappedRecord record = Measured({"plant.shaft.backlash.initial_twist_rad=0.05"}, 0.005);
  const std::vector<double>& measured = *record.outputs.at("omega_1").values;
  const auto prepared = Line({}, &record);
  const auto solver = MakeRealtimeSolver(*prepared->rig);
  const Result<Samples> free_run = Simulate(*prepared->rig, **solver);
  ASSERT_TRUE(free_run.ok());
  const auto from = static_cast<std::size_t>(0.2 / Seconds(prepared->rig->period));
  const double in_windows = Nrmse(measured, Predicted(record), from),
               freely = Nrmse(measured, free_run->outputs[0], from);
  // Measured: 0.013 and 0.88, with noise of 0.005; an impact of one window may shift on another machine.
  EXPECT_LT(in_windows, 0.03);
  EXPECT_GT(freely, 10.0 * in_windows);
}

TEST_F(PredictionWindows, NoSampleOfAWindowTakesPartInIt) {
  const MappedRecord record = Measured({}, 0.005);
  MappedRecord spoilt = record;
  const auto window = static_cast<std::size_t>(kWindow_s / 1e-4 + 0.5);
  const std::size_t begin = 4 * window;
  for (auto& [name, series] : spoilt.outputs) {
    std::vector<double> values = *series.values;
    for (std::size_t k = begin; k < values.size(); ++k) values[k] = -values[k];
    series.values = std::make_shared<const std::vector<double>>(std::move(values));
  }
  // The noise that gains count on comes from the whole record; it must be the same.
  const auto prepared = Line({}, &record);
  const Rig& rig = *prepared->rig;
  Result<Observer> observer = MakeObserver(rig, record, kWindow_s);
  ASSERT_TRUE(observer.ok());
  const auto solver = MakeRealtimeSolver(rig);
  const Result<Samples> before = PredictInWindows(rig, **solver, *observer);
  for (std::size_t j = 0; j < observer->outputs.size(); ++j) {
    const std::vector<double>& values = *spoilt.outputs.at(observer->outputs[j]).values;
    std::copy(values.begin(), values.end(), observer->measured[j].begin());
  }
  const Result<Samples> after = PredictInWindows(rig, **solver, *observer);
  ASSERT_TRUE(before.ok() && after.ok());
  for (std::size_t k = 0; k < begin + window; ++k) ASSERT_EQ(before->outputs[0][k], after->outputs[0][k]) << k;
  EXPECT_NE(before->outputs[0][begin + window + 1], after->outputs[0][begin + window + 1]);
}

// Corrected on one half alone, or on neither, the run beside the record wandered off by 1e7 of a torque's spread.
TEST_F(PredictionWindows, HalvesOfAMassOnAStiffJointStartAsTheWholeDoes) {
  const MappedRecord record = Measured({}, 0.005);
  const auto prepared = Line({}, &record);
  const Result<Observer> observer = MakeObserver(*prepared->rig, record, kWindow_s);
  ASSERT_TRUE(observer.ok());
  const auto halves = Line({R"(effect=[{name="series_elasticity",at="inertia:I9",parameters={k=1e6,c=50}}])"}, &record);
  const auto solver = MakeRealtimeSolver(*halves->rig);
  const Result<Samples> samples = PredictInWindows(*halves->rig, **solver, *observer);
  ASSERT_TRUE(samples.ok());
  const auto from = static_cast<std::size_t>(kWindow_s / 1e-4);
  const std::vector<double>& measured = *record.outputs.at("omega_1").values;
  // Measured: 0.013 for both.
  EXPECT_LT(Nrmse(measured, samples->outputs[0], from), 2.0 * Nrmse(measured, Predicted(record), from));
}

TEST_F(PredictionWindows, WithoutCorrectionsTheyAreTheFreeRun) {
  const MappedRecord record = Measured({}, 0.0);
  const auto prepared = Line({}, &record);
  const Rig& rig = *prepared->rig;
  Result<Observer> observer = MakeObserver(rig, record, kWindow_s);
  ASSERT_TRUE(observer.ok());
  std::fill(observer->gains.begin(), observer->gains.end(), 0.0F);
  const auto solver = MakeRealtimeSolver(rig), other = MakeRealtimeSolver(rig);
  const Result<Samples> windows = PredictInWindows(rig, **solver, *observer), free_run = Simulate(rig, **other);
  ASSERT_TRUE(windows.ok() && free_run.ok());
  for (std::size_t k = 0; k < windows->time.size(); ++k)
    ASSERT_EQ(windows->outputs[0][k], free_run->outputs[0][k]) << k;
}

TEST_F(PredictionWindows, ARecordOfOneWindowHasNoPast) {
  MappedRecord record = Measured({}, 0.0);
  const auto prepared = Line({}, &record);
  const Result<Observer> observer = MakeObserver(*prepared->rig, record, 0.3);
  ASSERT_FALSE(observer.ok());
  EXPECT_EQ(observer.failure().exit_code, 2);
}

}  // namespace
}  // namespace dynoproof
