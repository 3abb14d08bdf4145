// A pair of which neither half is the effect that removes most alone.
#include "diagnosis/second_look.h"

#include <gtest/gtest.h>

#include <set>

#include "diagnosis/contest.h"
#include "diagnosis/trial.h"
#include "identification/estimation_problem.h"
#include "tests/estimation/made_record.h"

namespace dynoproof::diagnosis {
namespace {

using estimation::RecordOf;
using estimation::Scenario;
using estimation::WithEffect;

TEST(SlowSecondLook, GoesOnFromAHalfOfThePairAndNotFromWhatRemovesMostAlone) {
  const Plan plan = Scenario("scenarios/diagnose/fuel_gas.toml", {"run.duration_s=10"});
  // A pressure that is limited, read by a sensor that is off: alone, a bent characteristic of the input stands for both.
  const Plan truth = WithEffect(WithEffect(plan, "actuator_saturation", "input:p_mem", {509e3}), "sensor_offset",
                                "output:p_g", {-10000.0});
  const MappedRecord record = RecordOf(truth, 0.014, {"p_g"});
  const auto levels = Levels::Of(plan, {record}, testing::BuiltIns(), 0.0, 10'000);
  ASSERT_TRUE(levels.ok()) << levels.failure().ToString();
  const EstimationProblem problem(plan, {record}, testing::BuiltIns());
  const Magnitudes magnitudes = MagnitudesOf(problem);
  const Result<Contest> contest = Compete(NullOf(plan, false, **levels, testing::BuiltIns()), false, **levels,
                                          magnitudes, testing::BuiltIns(), Conduct());
  ASSERT_TRUE(contest.ok()) << contest.failure().ToString();
  const std::set<std::string> halves = {"actuator_saturation@input:p_mem", "sensor_offset@output:p_g"};
  const Contestant* alone = LeaderAt(contest->contestants, **levels, (*levels)->longest());
  ASSERT_NE(alone, nullptr);
  EXPECT_FALSE(halves.contains(alone->Name())) << alone->Name() << ": then the best one would do";
  const std::vector<Base> bases = BasesOfPairs(*contest, **levels, magnitudes, testing::BuiltIns(), Conduct());
  ASSERT_GE(bases.size(), 2U);
  double least = LogExcess(bases.front().fit().scales, (*levels)->data());
  for (const Base& base : bases) {
    EXPECT_EQ(base.pair.hypothesis.effects().size(), 2U);
    EXPECT_GE(LogExcess(base.fit().scales, (*levels)->data()), least);
    least = LogExcess(base.fit().scales, (*levels)->data());
  }
  Settled settled;
  settled.causes = {static_cast<std::size_t>(alone - contest->contestants.data())};
  Journal journal;
  // A dead zone of an input that never turns is an offset of it: beside the limit it leaves what the sensor's offset leaves, and
  // which of the two pairs comes first is noise. The limit is a half of both.
  const std::optional<std::size_t> base = BaseOf(*contest, settled, bases, **levels, journal);
  ASSERT_TRUE(base);
  EXPECT_TRUE(halves.contains(contest->contestants[*base].Name())) << contest->contestants[*base].Name();
  EXPECT_EQ(journal.size(), 1U);
  EXPECT_EQ(BaseOf(*contest, Settled(), {}, **levels, journal), std::nullopt) << "nothing to go on from";
}

}  // namespace
}  // namespace dynoproof::diagnosis
