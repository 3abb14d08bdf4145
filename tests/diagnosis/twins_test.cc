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

using estimation::RecordOf;
using estimation::Scenario;
using estimation::WithEffect;

/// A torque that is 1.08 times what was asked for. A linear line that shows a torque alone does not tell that from a torque sensor that shows
/// so much more.
class Twins : public ::testing::Test {
 protected:
  explicit Twins(const std::vector<std::string>& outputs = {"T_shaft"})
      : record_(RecordOf(WithEffect(plan_, "actuator_gain", "input:T_airgap", {1.08}), 0.01, outputs)) {}

  /// A contest in which the gain of the drive was carried, and a gain and a lag of the torque sensor were left behind.
  Contest Carried() const {
    Contest contest;
    contest.first = level_;
    contest.contestants.push_back(NullOf(plan_, false, *levels_, testing::BuiltIns()));
    const Contestant null = contest.null();
    const auto looked = [&](const char* effect, const char* at, double value) {
      const auto model = null.hypothesis.With(*testing::BuiltIns().FindEffect(effect), *ParsePlace(at), magnitudes_);
      Eigen::VectorXd from = StartFrom(model, null.hypothesis, null.levels[level_].q);
      from[0] = model.parameters()[0].CoordinateOf(value);
      return FitOnce(model, from, null, *levels_, level_, 1);
    };
    Contestant cause = looked("actuator_gain", "input:T_airgap", 1.08);
    Eigen::VectorXd truth = cause.hypothesis.start();
    truth[0] = cause.hypothesis.parameters()[0].CoordinateOf(1.08);
    cause.levels[level_] = estimation::Fit(cause.hypothesis, (*levels_)[level_], truth, {.near = true});
    contest.contestants.push_back(cause);
    contest.left_behind = {looked("sensor_gain", "output:T_shaft", 1.05), looked("sensor_lag", "output:T_shaft", 1e-4)};
    return contest;
  }
  static std::vector<std::string> Names(const std::vector<Contestant>& some) {
    std::vector<std::string> names;
    for (const Contestant& one : some) names.push_back(one.Name());
    return names;
  }

  Plan plan_ = Scenario("scenarios/diagnose/heavy_duty_lumped.toml", {"run.duration_s=0.3"});
  MappedRecord record_;
  std::unique_ptr<Levels> levels_ = *Levels::Of(plan_, {record_}, testing::BuiltIns(), 0.0, 1000);
  Magnitudes magnitudes_ = MagnitudesOf(EstimationProblem(plan_, {record_}, testing::BuiltIns()));
  std::size_t level_ = levels_->free_run();
};

class TwinsTold : public Twins {
 protected:
  TwinsTold() : Twins({"T_shaft", "omega_1"}) {}
};

TEST_F(Twins, AreCarriedFromTheBestModel) {
  Contest contest = Carried();
  ASSERT_TRUE(IsExact(contest.contestants[1].levels[level_]));
  CarryTwins(contest, *levels_, level_, magnitudes_, {});
  ASSERT_EQ(Names(contest.contestants),
            (std::vector<std::string>{"nominal", "actuator_gain@input:T_airgap", "sensor_gain@output:T_shaft"}));
  const Contestant& twin = contest.contestants.back();
  EXPECT_TRUE(IsExact(twin.levels[level_]));
  const auto gain = [&](const Contestant& one) {
    return one.hypothesis.parameters()[0].ValueAt(one.levels[level_].q[0]);
  };
  EXPECT_NEAR(gain(twin), gain(contest.contestants[1]), 0.015) << "to what nominal values of 1 % leave open";
  EXPECT_EQ(Names(contest.left_behind), std::vector<std::string>{"sensor_lag@output:T_shaft"}) << "does something else";
}

TEST_F(TwinsTold, AreNoneWhereASpeedIsShown) {
  Contest contest = Carried();
  ASSERT_TRUE(IsExact(contest.contestants[1].levels[level_]));
  const std::int64_t before = levels_->simulations();
  CarryTwins(contest, *levels_, level_, magnitudes_, {});
  EXPECT_EQ(contest.contestants.size(), 2U);
  EXPECT_LE(levels_->simulations() - before, 3) << "one run without the cause, and one for each that was left behind";
}

TEST_F(Twins, OfTheNullAreNotAskedFor) {
  Contest contest = Carried();
  contest.contestants.pop_back();
  const std::int64_t before = levels_->simulations();
  CarryTwins(contest, *levels_, level_, magnitudes_, {});
  EXPECT_EQ(contest.contestants.size(), 1U);
  EXPECT_EQ(levels_->simulations(), before);
}

}  // namespace
}  // namespace dynoproof::diagnosis
