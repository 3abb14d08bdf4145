// The first look finds what nominal values have swallowed, and ends where a candidate is exact in the free run.
#include "diagnosis/first_look.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "diagnosis/contest.h"
#include "tests/estimation/made_record.h"

namespace dynoproof::diagnosis {
namespace {

using estimation::RecordOf;
using estimation::Scenario;
using estimation::WithEffect;

/// A speed that is read too high looks like inertias and stiffnesses that are too low, all by the same share: torques are then the same.
TEST(FirstLook, TakesBackWhatNominalValuesHaveSwallowed) {
  constexpr double kGain = 1.025;
  const Plan plan = Scenario("scenarios/diagnose/coupling.toml", {"run.duration_s=0.2"});
  const MappedRecord record =
      RecordOf(WithEffect(plan, "sensor_gain", "output:omega_d", {kGain}), 0.004, {"T", "omega_d"});
  const auto levels = Levels::Of(plan, {record}, testing::BuiltIns(), 0.0, 1000);
  ASSERT_TRUE(levels.ok()) << levels.failure().ToString();
  const std::size_t free = (*levels)->free_run();
  Contestant null(NullHypothesis(plan, false, **levels, testing::BuiltIns()));
  Eigen::VectorXd swallowed = null.hypothesis.start();
  for (std::size_t i = 0; i < null.hypothesis.parameters().size(); ++i) {
    const estimation::Parameter& number = null.hypothesis.parameters()[i];
    if (number.prior) swallowed[static_cast<Eigen::Index>(i)] = number.CoordinateOf(number.reference / kGain);
  }
  null.levels.resize((*levels)->size());
  for (estimation::Estimate& fit : null.levels) fit.broken = "not fitted";
  null.levels[free] = estimation::Fit(null.hypothesis, (**levels)[free], swallowed, {.near = true});
  ASSERT_TRUE(null.Holds(free)) << null.levels[free].broken;
  ASSERT_TRUE(IsExact(null.levels[free])) << TimesNoise(null.levels[free]);
  ASSERT_GT(OffNominal(null, free), 30.0);
  const auto takes = [](const Trial& trial) {
    return trial.place.ToString() == "output:omega_d" && trial.effect->info().name == "sensor_gain";
  };
  const Magnitudes magnitudes = MagnitudesOf(EstimationProblem(plan, {record}, testing::BuiltIns()));
  const Looked looked =
      FirstLook(null, **levels, free, magnitudes, testing::BuiltIns(), Conduct(), {.takes = takes, .levels = 1});
  ASSERT_EQ(looked.ranked.size(), 1U);
  const Contestant& gain = looked.ranked.front();
  EXPECT_TRUE(IsExact(gain.levels[free])) << TimesNoise(gain.levels[free]);
  EXPECT_LT(OffNominal(gain, free), 5.0);
  EXPECT_NEAR(gain.hypothesis.parameters()[0].ValueAt(gain.levels[free].q[0]), kGain, 0.01);
}

/// The look fits sixteen candidates at a time. Where the free run of the best of them leaves nothing but noise, it fits no more: the others
/// stand at the end of the ranking, with the share that their sketches promise.
TEST(FirstLook, EndsWhereTheFreeRunLeavesNothingButNoise) {
  const Plan plan = Scenario("scenarios/diagnose/heavy_duty_lumped.toml", {"run.duration_s=0.3"});
  const MappedRecord record =
      RecordOf(WithEffect(plan, "inertia_change", "inertia:I3", {0.2}), 0.005, {"T_shaft", "omega_1"});
  const auto levels = Levels::Of(plan, {record}, testing::BuiltIns(), 0.0, 2000);
  ASSERT_TRUE(levels.ok()) << levels.failure().ToString();
  const Contestant null = NullOf(plan, false, **levels, testing::BuiltIns());
  ASSERT_TRUE(null.Holds(0));
  const Magnitudes magnitudes = MagnitudesOf(EstimationProblem(plan, {record}, testing::BuiltIns()));
  const auto look = [&](bool until_exact) {
    const std::int64_t before = (*levels)->simulations();
    Looked looked =
        FirstLook(null, **levels, 0, magnitudes, testing::BuiltIns(), Conduct(), {.until_exact = until_exact});
    return std::pair(std::move(looked), (*levels)->simulations() - before);
  };
  const auto [all, of_all] = look(false);
  const auto [some, of_some] = look(true);
  EXPECT_EQ(some.ranked.front().Name(), "inertia_change@inertia:I3");
  EXPECT_EQ(some.ranked.front().share, all.ranked.front().share);
  const auto fitted = [](const Contestant& one) { return one.Holds(0) || one.Holds(1); };
  EXPECT_EQ(std::ranges::count_if(all.ranked, fitted), std::ssize(all.ranked));
  EXPECT_EQ(std::ranges::count_if(some.ranked, fitted), 16);
  EXPECT_TRUE(std::ranges::is_partitioned(some.ranked, fitted));
  EXPECT_GE(some.ranked.size(), all.ranked.size());
  for (const Contestant& one : some.ranked) EXPECT_EQ(one.levels[0].q.size(), std::ssize(one.hypothesis.parameters()));
  EXPECT_LT(of_some, of_all - 4 * (std::ssize(all.ranked) - 16)) << "each of the others takes some runs";
}

}  // namespace
}  // namespace dynoproof::diagnosis
