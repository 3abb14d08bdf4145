// Effects that do what the best model's does, once nominal values follow.
#include "diagnosis/twins.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <vector>

#include "diagnosis/first_look.h"
#include "diagnosis/policy.h"
#include "identification/estimation_problem.h"
#include "tests/estimation/made_record.h"

namespace dynoproof::diagnosis {
namespace {

using estimation::Hypothesis;
using estimation::RecordOf;
using estimation::Scenario;
using estimation::WithEffect;

/// A contest about a record of the lumped line, in which one effect was carried and others were left behind.
class Twins : public ::testing::Test {
 protected:
  struct Hidden {
    const char *effect, *at;
    std::vector<double> values;
  };

  /// `plan`: what else is hidden, in a plan of its own.
  void Begin(const Hidden& hidden, const std::vector<std::string>& outputs, const Plan* plan = nullptr) {
    record_ =
        RecordOf(WithEffect(plan != nullptr ? *plan : plan_, hidden.effect, hidden.at, hidden.values), 0.01, outputs);
    levels_ = *Levels::Of(plan_, {record_}, testing::BuiltIns(), 0.0, 1000);
    magnitudes_ = MagnitudesOf(EstimationProblem(plan_, {record_}, testing::BuiltIns()));
    level_ = contest_.first = levels_->free_run();
    contest_.contestants = {NullOf(plan_, false, *levels_, testing::BuiltIns())};
    contest_.contestants.push_back(Found(contest_.null().hypothesis, {hidden}));
    ASSERT_TRUE(plan != nullptr || IsExact(contest_.contestants.back().levels[level_]));
  }
  /// A model with these effects, fitted from their values.
  Contestant Found(Hypothesis model, const std::vector<Hidden>& all) const {
    std::vector<double> values;
    for (const Hidden& one : all) {
      model = model.With(*testing::BuiltIns().FindEffect(one.effect), *ParsePlace(one.at), magnitudes_);
      values.insert(values.end(), one.values.begin(), one.values.end());
    }
    Eigen::VectorXd truth = model.start();
    for (std::size_t i = 0; i < values.size(); ++i)
      truth[static_cast<Eigen::Index>(i)] = model.parameters()[i].CoordinateOf(values[i]);
    Contestant found(model);
    found.levels.assign(levels_->size(), {});
    for (estimation::Estimate& fit : found.levels) fit.broken = "not fitted";
    found.levels[level_] = estimation::Fit(model, (*levels_)[level_], truth, {.near = true});
    found.share = 0.5;
    return found;
  }
  /// A torque that is 1.08 times what was asked for. A linear line that shows a torque alone does not tell that from a torque sensor that
  /// shows so much more.
  void BeginWithGain(const std::vector<std::string>& outputs, const Plan* plan = nullptr) {
    Begin({"actuator_gain", "input:T_airgap", {1.08}}, outputs, plan);
    contest_.left_behind = {Looked("sensor_gain", "output:T_shaft", 1.05),
                            Looked("sensor_lag", "output:T_shaft", 1e-4)};
  }
  Contestant Looked(const char* effect, const char* at, double value) const {
    const Contestant& null = contest_.null();
    const auto model = null.hypothesis.With(*testing::BuiltIns().FindEffect(effect), *ParsePlace(at), magnitudes_);
    Eigen::VectorXd from = StartFrom(model, null.hypothesis, null.levels[level_].q);
    from[0] = model.parameters()[0].CoordinateOf(value);
    return FitOnce(model, from, null, *levels_, level_, 1);
  }
  std::int64_t Carry() {
    const std::int64_t before = levels_->simulations();
    CarryTwins(contest_, *levels_, level_, magnitudes_);
    return levels_->simulations() - before;
  }
  static std::vector<std::string> Names(const std::vector<Contestant>& some) {
    std::vector<std::string> names;
    for (const Contestant& one : some) names.push_back(one.Name());
    return names;
  }

  Plan plan_ = Scenario("scenarios/diagnose/heavy_duty_lumped.toml", {"run.duration_s=0.3"});
  MappedRecord record_;
  std::unique_ptr<Levels> levels_;
  Magnitudes magnitudes_;
  std::size_t level_ = 0;
  Contest contest_;
};

TEST_F(Twins, AreCarriedFromTheBestModel) {
  BeginWithGain({"T_shaft"});
  Carry();
  ASSERT_EQ(Names(contest_.contestants),
            (std::vector<std::string>{"nominal", "actuator_gain@input:T_airgap", "sensor_gain@output:T_shaft"}));
  const Contestant& twin = contest_.contestants.back();
  EXPECT_TRUE(IsExact(twin.levels[level_]));
  const auto gain = [&](const Contestant& one) {
    return one.hypothesis.parameters()[0].ValueAt(one.levels[level_].q[0]);
  };
  EXPECT_NEAR(gain(twin), gain(contest_.contestants[1]), 0.015) << "to what nominal values of 1 % leave open";
  EXPECT_EQ(Names(contest_.left_behind), std::vector<std::string>{"sensor_lag@output:T_shaft"})
      << "does something else";
}

TEST_F(Twins, AreNoneWhereASpeedIsShown) {
  BeginWithGain({"T_shaft", "omega_1"});
  EXPECT_LE(Carry(), 3) << "one run without the cause, and one for each that was left behind";
  EXPECT_EQ(contest_.contestants.size(), 2U);
}

TEST_F(Twins, OfTheNullAreNotAskedFor) {
  BeginWithGain({"T_shaft"});
  contest_.contestants.pop_back();
  EXPECT_EQ(Carry(), 0);
  EXPECT_EQ(contest_.contestants.size(), 1U);
}

TEST_F(Twins, AreNotLookedForAtAPlaceThatTheBestModelHasTakenAway) {
  Begin({"distributed_inertia", "rotor:rotor", {26.8, 1.58e7, 90.0}}, {"T_shaft", "omega_1"});
  contest_.left_behind = {Looked("inertia_change", "inertia:I2", 0.1)};
  ASSERT_TRUE(contest_.left_behind.front().Holds(level_));
  EXPECT_EQ(Carry(), 1) << "the run without the rotor";
  EXPECT_EQ(contest_.contestants.size(), 2U);
}

TEST_F(Twins, AreNotLookedForWhereACandidateRanAtNoLevel) {
  BeginWithGain({"T_shaft"});
  for (estimation::Estimate& one : contest_.left_behind.front().levels) {
    one = estimation::Estimate();
    one.broken = "its run stops";
  }
  contest_.left_behind.pop_back();
  EXPECT_EQ(Carry(), 1) << "the run without the cause";
  EXPECT_EQ(contest_.contestants.size(), 2U);
}

TEST_F(Twins, OfTheEffectThatCameFirstAreCarried) {
  const Plan late = WithEffect(plan_, "sensor_lag", "output:T_shaft", {3e-3});
  BeginWithGain({"T_shaft"}, &late);
  Contest pairs;
  pairs.first = level_;
  const Hypothesis nominal = contest_.null().hypothesis;
  const Hidden gain = {"actuator_gain", "input:T_airgap", {1.08}}, lag = {"sensor_lag", "output:T_shaft", {3e-3}};
  pairs.contestants = {Found(nominal, {gain}), Found(nominal, {gain, lag})};
  ASSERT_TRUE(IsExact(pairs.contestants[1].levels[level_]));
  EXPECT_TRUE(CarryTwinsOfBase(pairs, contest_, nominal, *levels_, level_, magnitudes_));
  ASSERT_EQ(pairs.contestants.size(), 3U);
  EXPECT_EQ(pairs.contestants[2].Name(), "sensor_lag@output:T_shaft + sensor_gain@output:T_shaft");
  EXPECT_TRUE(IsExact(pairs.contestants[2].levels[level_]));
}

}  // namespace
}  // namespace dynoproof::diagnosis
