// The first look beside a nominal model that leaves nothing but noise.
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

}  // namespace
}  // namespace dynoproof::diagnosis
