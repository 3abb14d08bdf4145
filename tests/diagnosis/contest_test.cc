// Which candidates a contest carries.
#include "diagnosis/contest.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "diagnosis/trial.h"
#include "identification/estimation_problem.h"
#include "tests/estimation/made_record.h"

namespace dynoproof::diagnosis {
namespace {

using estimation::RecordOf;
using estimation::Scenario;
using estimation::WithEffect;

TEST(Contest, CarriesWhatAnotherPassHasAdmitted) {
  const Plan plan = Scenario("scenarios/diagnose/heavy_duty_lumped.toml", {"run.duration_s=0.3"});
  const MappedRecord record = RecordOf(WithEffect(plan, "viscous_friction", "inertia:I5", {0.5}), 0.01, {"T_shaft"});
  const auto levels = Levels::Of(plan, {record}, testing::BuiltIns(), 0.0, 1000);
  ASSERT_TRUE(levels.ok()) << levels.failure().ToString();
  const Magnitudes magnitudes = MagnitudesOf(EstimationProblem(plan, {record}, testing::BuiltIns()));
  const Contestant null = NullOf(plan, false, **levels, testing::BuiltIns());
  const Result<Contest> alone = Compete(null, false, **levels, magnitudes, testing::BuiltIns(), Conduct());
  ASSERT_TRUE(alone.ok()) << alone.failure().ToString();
  const auto worst = std::find_if(alone->left_behind.rbegin(), alone->left_behind.rend(),
                                  [&](const Contestant& one) { return one.Holds(alone->first); });
  ASSERT_NE(worst, alone->left_behind.rend());
  const Contestant admitted[] = {*worst, alone->contestants[1]};
  const Result<Contest> both = Compete(null, false, **levels, magnitudes, testing::BuiltIns(), Conduct(), admitted);
  ASSERT_TRUE(both.ok()) << both.failure().ToString();
  const auto carried = [&](const Contest& contest, const std::string& name) {
    return std::ranges::count(contest.contestants, name, &Contestant::Name);
  };
  EXPECT_EQ(carried(*alone, worst->Name()), 0);
  EXPECT_EQ(carried(*both, worst->Name()), 1);
  EXPECT_EQ(carried(*both, admitted[1].Name()), 1) << "was among the first anyway";
  EXPECT_EQ(both->contestants.size(), alone->contestants.size() + 1);
  for (const estimation::Estimate& fit : both->contestants.back().levels)
    EXPECT_NE(fit.broken, "not fitted") << "went through all levels";
}

/// A gain for the line with its gap open makes the closed one swing: there the record's last digits correct the run away from what it is
/// without any correction, and nothing is told.
TEST(NullOf, LeavesALevelAtWhichTheRecordUpsetsARightModel) {
  const Plan plan = Scenario("scenarios/backlash/experiment_1.toml", {});
  const MappedRecord record =
      RecordOf(plan, 0.0, {"T_1", "T_2", "T_m1", "T_m2", "omega_1", "omega_2", "omega_3", "omega_d", "phi_d"});
  const auto levels = Levels::Of(plan, {record}, testing::BuiltIns(), 0.0, 1000);
  ASSERT_TRUE(levels.ok()) << levels.failure().ToString();
  const Contestant null = NullOf(plan, false, **levels, testing::BuiltIns());
  ASSERT_TRUE(null.Holds((*levels)->free_run())) << null.levels.back().broken;
  EXPECT_TRUE(IsExact(null.levels.back()));
  for (std::size_t level = 0; level < (*levels)->free_run(); ++level)
    EXPECT_TRUE(!null.Holds(level) || IsNearTheNoise(null.levels[level])) << (*levels)->Name(level);
}

/// Until it acts, an adaptive control's outputs stand still, some of them at 0: of these noise is nothing, and neither is what rounding makes.
TEST(NullOf, IsExactBesideOutputsThatStandStill) {
  const Plan plan = Scenario("scenarios/heavy_duty/control_c_oscillation.toml", {"run.duration_s=0.2"});
  const MappedRecord record = RecordOf(plan, 0.0, {"T_shaft", "omega_1", "eta_1", "notch_1", "outcome", "placements"});
  const auto levels = Levels::Of(plan, {record}, testing::BuiltIns(), 0.0, 1000);
  ASSERT_TRUE(levels.ok()) << levels.failure().ToString();
  const Contestant null = NullOf(plan, false, **levels, testing::BuiltIns());
  ASSERT_TRUE(null.Holds((*levels)->free_run())) << null.levels.back().broken;
  EXPECT_TRUE(IsExact(null.levels.back()));
}

}  // namespace
}  // namespace dynoproof::diagnosis
