// Which memories beyond a record's length a model is led through on its way to the free run.
#include "diagnosis/carry.h"

#include <gtest/gtest.h>

#include "diagnosis/contest.h"
#include "tests/estimation/made_record.h"

namespace dynoproof::diagnosis {
namespace {

using estimation::RecordOf;
using estimation::Scenario;

class SteppingStones : public ::testing::Test {
 protected:
  SteppingStones() : plan_(Scenario("scenarios/diagnose/heavy_duty_lumped.toml", {"run.duration_s=0.3"})) {
    Result<std::unique_ptr<Levels>> levels =
        Levels::Of(plan_, {RecordOf(plan_, 0.01, {"T_shaft", "omega_1"})}, testing::BuiltIns(), 0.0, 10'000);
    if (levels.ok()) levels_ = *std::move(levels);
  }

  std::size_t stone() const { return levels_->longest() + 1; }

  /// The nominal model as it stands, which has come to the first memory beyond the record's length.
  Contestant AsGiven() const {
    Contestant one(NullHypothesis(plan_, false, *levels_, testing::BuiltIns()));
    one.levels.resize(levels_->size());
    for (estimation::Estimate& fit : one.levels) fit.broken = "not fitted";
    one.levels[stone()] = estimation::Fit(one.hypothesis, (*levels_)[stone()], one.hypothesis.start(), {.renewals = 0});
    return one;
  }

  Plan plan_;
  std::unique_ptr<Levels> levels_;
};

TEST_F(SteppingStones, LieBetweenTheLongestMemoryWithinTheRecordAndTheFreeRun) {
  ASSERT_NE(levels_, nullptr);
  ASSERT_GE(levels_->free_run(), levels_->longest() + 3);
  for (std::size_t level = 0; level < levels_->size(); ++level)
    EXPECT_EQ(levels_->IsSteppingStone(level), level > levels_->longest() && level < levels_->free_run()) << level;
}

TEST_F(SteppingStones, AreNotNeededWhereTheFreeRunLeavesNoMore) {
  ASSERT_NE(levels_, nullptr);
  const Contestant one = AsGiven();
  ASSERT_TRUE(one.Holds(stone())) << one.levels[stone()].broken;
  EXPECT_EQ(SteppedOver(one, *levels_, stone() + 1), "the free run is reached without");
  EXPECT_EQ(SteppedOver(one, *levels_, levels_->free_run()), "");
}

/// A stiffness that is off by ten standard deviations of its prior shows less where the record corrects the run.
TEST_F(SteppingStones, AreNeededWhereTheFreeRunLeavesMore) {
  ASSERT_NE(levels_, nullptr);
  Contestant one = AsGiven();
  estimation::Estimate& fit = one.levels[stone()];
  ASSERT_TRUE(fit.ok()) << fit.broken;
  const auto& parameters = one.hypothesis.parameters();
  const auto own = std::ranges::find_if(
      parameters, [](const estimation::Parameter& of) { return of.name.find("stiffness") != std::string::npos; });
  ASSERT_NE(own, parameters.end());
  fit.q[own - parameters.begin()] += 10.0;
  EXPECT_EQ(SteppedOver(one, *levels_, stone() + 1), "");
  for (estimation::ChannelScale& scale : fit.scales) scale.rms = 10.0 * scale.noise_alone;
  EXPECT_EQ(SteppedOver(one, *levels_, stone() + 1), "far from the noise before");
}

/// A null whose run has broken, or which has stepped over a level, may be found there by another's values.
TEST_F(SteppingStones, ANullThatWasNotFittedIsFoundByAnothersValues) {
  ASSERT_NE(levels_, nullptr);
  std::vector<Contestant> all = {AsGiven(), AsGiven()};
  const Effect* effect = testing::BuiltIns().FindEffect("viscous_friction");
  ASSERT_NE(effect, nullptr);
  all[1] = Contestant(all[0].hypothesis.With(*effect, *ParsePlace("inertia:I5"), Magnitudes{}));
  all[1].levels = all[0].levels;
  const std::size_t first = stone();
  all[1].levels[first] =
      estimation::Fit(all[1].hypothesis, (*levels_)[first], all[1].hypothesis.start(), {.renewals = 0});
  ASSERT_FALSE(all[0].Holds(levels_->free_run()));
  EXPECT_TRUE(Carry(all, *levels_, first, Conduct()));
  EXPECT_TRUE(all[0].Holds(levels_->free_run()));
  EXPECT_TRUE(IsExact(all[0].levels[levels_->free_run()])) << "the record is the nominal model's";
}

}  // namespace
}  // namespace dynoproof::diagnosis
