// The rows of the table that turns a contest into a verdict, each on fits that are made up: what they leave is a noise, and a
// share of a course that nothing but the truth removes.
#include "diagnosis/settle.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <string>
#include <vector>

#include "diagnosis/policy.h"
#include "tests/estimation/made_record.h"

namespace dynoproof::diagnosis {
namespace {

using estimation::Estimate;
using estimation::RecordOf;
using estimation::Scenario;

constexpr double kNoise = 0.01, kCourse = 0.1;  // RMS, of the output's spread

/// What a fit leaves: its share of the course, and a course of its own.
struct Left {
  const char* effect;
  const char* at;
  double share;
  double own = 0.0;
  double held_out = 0.0;  // excess on data that took no part, over that of the given plan
  bool on_bound = false;
  double off = 0.0;             // standard deviations of a nominal value from its prior
  bool at_noise_there = false;  // on data that took no part
};

class SettleTest : public ::testing::Test {
 protected:
  SettleTest()
      : plan_(Scenario("scenarios/diagnose/heavy_duty_lumped.toml", {"run.duration_s=0.3"})),
        levels_(*Levels::Of(plan_, {RecordOf(plan_, kNoise, {"T_shaft"})}, testing::BuiltIns(), 0.0, 1000)) {
    std::mt19937_64 random(7);
    std::normal_distribution<double> normal;
    const Eigen::Index rows = levels_->data().measured().size();
    for (Eigen::VectorXd* one : {&noise_, &course_}) {
      one->resize(rows);
      for (double& value : *one) value = normal(random);
    }
    noise_ *= Spread() * kNoise;
    course_ *= Spread() * kCourse;
  }

  double Spread() const { return levels_->data().channels()[0].spread; }

  Estimate EstimateOf(const estimation::Hypothesis& hypothesis, double share, double own, int stream) const {
    Estimate estimate;
    estimate.q = hypothesis.start();
    std::mt19937_64 random(static_cast<std::uint64_t>(100 + stream));
    std::normal_distribution<double> normal;
    estimate.innovations = noise_ + share * course_;
    for (double& value : estimate.innovations) value += own * Spread() * kCourse * normal(random);
    estimate.scales =
        estimation::ScalesOf(levels_->data(), estimate.innovations, Eigen::VectorXd::Constant(1, Spread() * kNoise));
    estimate.weighted = estimate.innovations / estimate.scales[0].rms;
    return estimate;
  }

  /// The null leaves the whole course, or this share of it; the same on data that took no part. Its nominal value is so far off.
  Settled SettledOf(const std::vector<Left>& candidates, double null = 1.0, double null_held_out = 1.0,
                    double null_off = 0.0) const {
    Contest& contest = contest_ = Contest();
    contest.released = false;
    std::vector<HeldOut> held_out;
    std::vector<double> least(levels_->size(), 0.0);
    const auto add = [&](estimation::Hypothesis hypothesis, const Left& left, int stream) {
      Contestant contestant(std::move(hypothesis));
      for (std::size_t level = 0; level < levels_->size(); ++level) {
        contestant.levels.push_back(EstimateOf(contestant.hypothesis, left.share, left.own, stream));
        if (left.on_bound) contestant.levels.back().q[0] = contestant.hypothesis.upper()[0];
        contestant.levels.back().q[contestant.levels.back().q.size() - 1] = left.off;
        least[level] = std::min(least[level], std::log(std::max(left.held_out, 1e-9)));
      }
      held_out.emplace_back(levels_->size(), LeftThere{std::log(std::max(left.held_out, 1e-9)), left.at_noise_there});
      contest.contestants.push_back(std::move(contestant));
    };
    const estimation::Hypothesis base = estimation::Hypothesis(plan_).WithNominalValuesFree(testing::BuiltIns());
    add(base, {.effect = "", .at = "", .share = null, .held_out = null_held_out, .off = null_off}, 0);
    int stream = 1;
    for (const Left& one : candidates)
      add(base.With(*testing::BuiltIns().FindEffect(one.effect), *ParsePlace(one.at), Magnitudes{}), one, stream++);
    return Settle(contest, *levels_, held_out, least);
  }

  Plan plan_;
  mutable Contest contest_;  // of the last call of SettledOf()
  std::unique_ptr<Levels> levels_;
  Eigen::VectorXd noise_, course_;
};

const Left kTruth{"viscous_friction", "inertia:I5", 0.0, 0.0, 0.02}, kFar{"constant_load", "inertia:I1", 0.8, 0.3, 0.7};

TEST_F(SettleTest, OneModelThatLeavesNothingButNoiseIsFound) {
  const Settled settled = SettledOf({kTruth, kFar});
  EXPECT_EQ(settled.verdict, Conclusion::kEffectFound) << settled.reason;
  EXPECT_EQ(settled.causes, std::vector<std::size_t>{1});
  EXPECT_TRUE(settled.exact);
  EXPECT_EQ(settled.level, levels_->free_run());
}

/// A refined law does not beat its plainer one by a lower residual power that lies within the uncertainty of the noise's power.
TEST_F(SettleTest, ARefinedLawDoesNotBeatItsPlainerOneByAHundredthOfTheNoise) {
  const auto found = [&](double course) {
    return SettledOf(
        {{"coulomb_friction", "inertia:I5", course, 0.0, 0.02}, {"stribeck_friction", "inertia:I5", 0.0, 0.0, 0.02}});
  };
  const double of_noise = kNoise / kCourse;  // as share of the course
  const Settled plain = found(0.1 * of_noise), refined = found(0.3 * of_noise);
  EXPECT_EQ(plain.causes, std::vector<std::size_t>{1}) << plain.reason;
  EXPECT_EQ(refined.causes, std::vector<std::size_t>{2}) << refined.reason;
}

TEST_F(SettleTest, ANullThatLeavesNothingButNoiseHasNoCause) {
  const Settled settled = SettledOf({{"viscous_friction", "inertia:I5", 0.0, 0.001, 1.0}, kFar}, 0.0);
  EXPECT_EQ(settled.verdict, Conclusion::kNoEffect) << settled.reason;
  EXPECT_TRUE(settled.causes.empty());
}

/// A null whose nominal values have swallowed an effect leaves nothing but noise, too.
TEST_F(SettleTest, OfANullThatLeavesNothingButNoiseNominalValuesTellThatItIsNotTheTruth) {
  const Left cause{"viscous_friction", "inertia:I5", 0.0, 0.001, 0.02};
  EXPECT_EQ(SettledOf({cause, kFar}, 0.0, 0.02, 3.9).verdict, Conclusion::kNoEffect) << "nearly four deviations";
  const Settled settled = SettledOf({cause, kFar}, 0.0, 0.02, 4.5);
  EXPECT_EQ(settled.verdict, Conclusion::kEffectFound) << settled.reason;
  EXPECT_EQ(settled.causes, std::vector<std::size_t>{1});
  Left as_far = cause;
  as_far.off = 4.4;
  EXPECT_EQ(SettledOf({as_far, kFar}, 0.0, 0.02, 4.5).verdict, Conclusion::kNoEffect) << "its own are as far off";
  Left worse = cause;
  worse.held_out = 5.0;
  EXPECT_NE(SettledOf({worse, kFar}, 0.0, 0.02, 4.5).verdict, Conclusion::kEffectFound) << "and it predicts less";
}

TEST_F(SettleTest, TwoThatLeaveTheSameAreASetAndFourAreNone) {
  const Left alike{"sensor_gain", "output:T_shaft", 0.0, 0.0, 0.02},
      third{"actuator_gain", "input:T_airgap", 0.0, 0.0, 0.02}, fourth{"inertia_change", "inertia:I5", 0.0, 0.0, 0.02};
  const Settled two = SettledOf({kTruth, kFar, alike});
  EXPECT_EQ(two.verdict, Conclusion::kAmbiguous) << two.reason;
  EXPECT_EQ(two.causes, (std::vector<std::size_t>{1, 3}));
  const Settled four = SettledOf({kTruth, alike, third, fourth});
  EXPECT_EQ(four.verdict, Conclusion::kUnexplained) << four.reason;
}

/// Unless it explains nearly all of what is wrong on data that took no part: then a value that they hardly show was pushed by what it did not.
TEST_F(SettleTest, AtTheEndOneThatNeedsANominalValueOnItsBoundDoesNotStand) {
  Left pushed{"sensor_gain", "output:T_shaft", 0.0, 0.0, 0.3};
  pushed.at_noise_there = true;
  pushed.off = 2.9;
  EXPECT_EQ(AtTheEnd(SettledOf({pushed, kFar}), contest_).verdict, Conclusion::kEffectFound);
  for (const double end : {3.0, -3.0}) {
    pushed.off = end;
    const Settled alone = AtTheEnd(SettledOf({pushed, kFar}), contest_);
    EXPECT_EQ(alone.verdict, Conclusion::kUnexplained);
    EXPECT_NE(alone.reason.find("on its bound"), std::string::npos) << alone.reason;
    EXPECT_EQ(alone.best, 1U) << "it is told what removes the error";
    Left nearly_all = pushed;
    nearly_all.held_out = 0.02;
    const Settled found = AtTheEnd(SettledOf({nearly_all, kFar}), contest_);
    EXPECT_EQ(found.verdict, Conclusion::kEffectFound);
    EXPECT_EQ(found.causes, std::vector<std::size_t>{1});
    EXPECT_TRUE(found.reason.ends_with("though with a nominal value on its bound")) << found.reason;
    const Settled set = AtTheEnd(SettledOf({nearly_all, kTruth, kFar}), contest_);
    EXPECT_EQ(set.verdict, Conclusion::kAmbiguous) << "that one of two is pushed does not make the other the cause";
  }
}

TEST_F(SettleTest, OfTwoThatLeaveTheSameOneFarFromItsDataSheetIsImplausible) {
  Left far{"sensor_gain", "output:T_shaft", 0.0, 0.0, 0.02};
  far.off = 2.5;
  EXPECT_EQ(SettledOf({kTruth, far}).verdict, Conclusion::kAmbiguous) << "two and a half deviations happen";
  far.off = 4.5;
  const Settled settled = SettledOf({kTruth, far});
  EXPECT_EQ(settled.verdict, Conclusion::kEffectFound) << settled.reason;
  EXPECT_EQ(settled.causes, std::vector<std::size_t>{1});
}

TEST_F(SettleTest, OfTwoThatLeaveTheSameOneThatPredictsOtherDataFarWorseIsNone) {
  Left other{"sensor_gain", "output:T_shaft", 0.0, 0.0, 1.5 * kTruth.held_out};
  EXPECT_EQ(SettledOf({kTruth, other}).verdict, Conclusion::kAmbiguous) << "half as much again is by chance";
  other.held_out = 5.0 * kTruth.held_out;
  const Settled settled = SettledOf({kTruth, other});
  EXPECT_EQ(settled.verdict, Conclusion::kEffectFound) << settled.reason;
  EXPECT_EQ(settled.causes, std::vector<std::size_t>{1});
  other.at_noise_there = true;
  EXPECT_EQ(SettledOf({kTruth, other}).verdict, Conclusion::kAmbiguous) << "there is nothing left to be worse by";
}

TEST_F(SettleTest, AnExactModelBesideASmallShareOfItsOwnIsNoCause) {
  // The null leaves hardly more than noise: what an effect removes of that is less than a fifth.
  const Settled settled = SettledOf({{"viscous_friction", "inertia:I5", 0.048, 0.0, 0.9}}, 0.05);
  EXPECT_NE(settled.verdict, Conclusion::kEffectFound) << settled.reason;
  EXPECT_TRUE(settled.causes.empty());
}

/// Friction is not seen where the body that rubs stands still: such data cannot speak against it.
TEST_F(SettleTest, DataThatTookNoPartAndShowNothingDoNotRefuteACause) {
  Left cause = kTruth;
  cause.held_out = 1.0;
  EXPECT_EQ(SettledOf({cause, kFar}).verdict, Conclusion::kUnexplained)
      << "something is left there, and it takes nothing of it";
  cause.at_noise_there = true;
  EXPECT_EQ(SettledOf({cause, kFar}).verdict, Conclusion::kEffectFound);
}

/// Both take nearly all of what the plan as given leaves there; of the little that is left a tenth more or less says nothing. A cause
/// that leaves more than twice as much, and more than noise, has followed what only the training data show.
TEST_F(SettleTest, DataThatTookNoPartAndSuitTheNullAsWellDoNotRefuteACause) {
  Left cause = kTruth;
  cause.held_out = 0.011;
  EXPECT_EQ(SettledOf({cause, kFar}, 1.0, 0.01).verdict, Conclusion::kEffectFound);
  cause.held_out = 0.021;
  EXPECT_EQ(SettledOf({cause, kFar}, 1.0, 0.01).verdict, Conclusion::kUnexplained) << "that is worse";
  cause.at_noise_there = true;
  EXPECT_EQ(SettledOf({cause, kFar}, 1.0, 0.01).verdict, Conclusion::kEffectFound)
      << "there is nothing left to be worse by";
}

/// What leaves nothing but noise on the training data alone has followed these.
TEST_F(SettleTest, OnDataThatTookNoPartACauseLeavesNoiseOrExplainsMostOfTheError) {
  Left cause = kTruth;
  cause.held_out = 0.3;
  const Settled alone = SettledOf({cause, kFar});
  EXPECT_EQ(alone.verdict, Conclusion::kUnexplained);
  EXPECT_EQ(alone.best, 1U);
  EXPECT_NE(alone.reason.find("70 % are explained there"), std::string::npos) << alone.reason;
  cause.held_out = 0.19;
  EXPECT_EQ(SettledOf({cause, kFar}).verdict, Conclusion::kEffectFound);
  cause.held_out = 0.3;
  cause.at_noise_there = true;
  EXPECT_EQ(SettledOf({cause, kFar}).verdict, Conclusion::kEffectFound);
}

TEST_F(SettleTest, ANumberOnItsBoundNamesNothing) {
  Left bound = kTruth;
  bound.on_bound = true;
  const Settled settled = SettledOf({bound, kFar});
  EXPECT_EQ(settled.verdict, Conclusion::kUnexplained) << settled.reason;
  EXPECT_TRUE(settled.causes.empty());
}

TEST_F(SettleTest, ALawThatAddsNothingToAPlainerOneStandsBack) {
  const Left plain{"coulomb_friction", "inertia:I5", 0.0, 0.0, 0.02},
      refined{"stribeck_friction", "inertia:I5", 0.0, 0.001, 0.02};
  const Settled settled = SettledOf({refined, plain, kFar});
  EXPECT_EQ(settled.verdict, Conclusion::kEffectFound) << settled.reason;
  EXPECT_EQ(settled.causes, std::vector<std::size_t>{2});
}

TEST_F(SettleTest, WhereNoModelIsExactTheShareOnDataThatTookNoPartDecides) {
  const Settled settled = SettledOf({{"coulomb_friction", "inertia:I5", 0.3, 0.0, 0.1}, kFar});
  EXPECT_EQ(settled.verdict, Conclusion::kMainCause) << settled.reason;
  EXPECT_EQ(settled.causes, std::vector<std::size_t>{1});
  EXPECT_FALSE(settled.exact);
  EXPECT_GE(settled.explains, policy::kMainCause);
  // The same fit, and on the other data no better than the plan as given.
  const Settled nothing = SettledOf({{"coulomb_friction", "inertia:I5", 0.3, 0.0, 0.95}});
  EXPECT_EQ(nothing.verdict, Conclusion::kUnexplained) << nothing.reason;
  EXPECT_TRUE(nothing.causes.empty());
}

TEST_F(SettleTest, WhereNoModelIsExactAThousandthLessIsNoReason) {
  const auto with = [&](double second) {
    return SettledOf({{.effect = "constant_load", .at = "inertia:I5", .share = 0.5, .held_out = 0.3},
                      {.effect = "constant_load", .at = "inertia:I4", .share = second, .held_out = 0.3}});
  };
  const Settled alike = with(0.5005), apart = with(0.52);
  EXPECT_EQ(alike.verdict, Conclusion::kAmbiguous) << alike.reason;
  ASSERT_EQ(apart.verdict, Conclusion::kMainCause) << apart.reason;
  EXPECT_EQ(apart.causes, std::vector<std::size_t>{1});
}

/// Dahl's law has two numbers and Stribeck's three: where they leave alike, the one with more of them stands only if it predicts better.
TEST_F(SettleTest, OfLawsThatRefineTheSameOneMoreNumbersStandForABetterPrediction) {
  const auto with = [&](double dahl, double stribeck) {
    return SettledOf({{.effect = "dahl_friction", .at = "inertia:I5", .share = 0.3, .held_out = dahl},
                      {.effect = "stribeck_friction", .at = "inertia:I5", .share = 0.3002, .held_out = stribeck}});
  };
  const Settled plainer = with(0.09, 0.12), better = with(0.12, 0.09);
  EXPECT_EQ(plainer.verdict, Conclusion::kMainCause) << plainer.reason;
  EXPECT_EQ(plainer.causes, std::vector<std::size_t>{1});
  EXPECT_EQ(better.verdict, Conclusion::kAmbiguous) << better.reason;
}

/// The journal gives the weight of the null model and its standard error at each level at which models were compared.
TEST_F(SettleTest, TheJournalHoldsTheWeightsThatDecided) {
  for (const double left : {0.0, 0.2}) {  // by weights, and by shares
    const Settled settled = SettledOf({{"viscous_friction", "inertia:I5", left, left, 0.02}, kFar});
    EXPECT_EQ(settled.exact, left == 0.0);
    ASSERT_FALSE(settled.journal.empty());
    const auto& numbers = settled.journal.front().numbers;
    const auto of_null = std::ranges::count_if(
        numbers, [](const auto& one) { return one.first.starts_with("weight_of_null") && std::abs(one.second) < 0.3; });
    EXPECT_GE(of_null, 1);
    EXPECT_EQ(std::ranges::count_if(numbers, [](const auto& one) { return one.first.starts_with("standard_error"); }),
              of_null);
  }
}

/// Alone or in a set: what takes a third of the error may be a first of two causes, and is no main one.
TEST_F(SettleTest, AtTheEndACauseExplainsAHalf) {
  const auto two_alike = [&](double held_out) {
    return SettledOf({{"coulomb_friction", "inertia:I5", 0.3, 0.0, held_out},
                      {"sensor_gain", "output:T_shaft", 0.3, 0.0, held_out}});
  };
  EXPECT_EQ(AtTheEnd(two_alike(0.3), contest_).verdict, Conclusion::kAmbiguous);
  EXPECT_EQ(two_alike(0.7).verdict, Conclusion::kAmbiguous);
  EXPECT_EQ(AtTheEnd(two_alike(0.7), contest_).verdict, Conclusion::kUnexplained);
  const Settled alone = SettledOf({{"coulomb_friction", "inertia:I5", 0.3, 0.0, 0.7}, kFar});
  EXPECT_EQ(alone.verdict, Conclusion::kMainCause);
  EXPECT_EQ(AtTheEnd(alone, contest_).verdict, Conclusion::kUnexplained);
  const Settled exact = SettledOf({kTruth, kFar});
  EXPECT_EQ(AtTheEnd(exact, contest_).verdict, Conclusion::kEffectFound) << "it leaves nothing";
}

TEST_F(SettleTest, ARunThatBreaksOnOtherDataIsNoCause) {
  const Settled settled = SettledOf({{"coulomb_friction", "inertia:I5", 0.3, 0.0, 1e300}});
  EXPECT_EQ(settled.verdict, Conclusion::kUnexplained) << settled.reason;
}

}  // namespace
}  // namespace dynoproof::diagnosis
