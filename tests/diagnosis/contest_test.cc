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

}  // namespace
}  // namespace dynoproof::diagnosis
