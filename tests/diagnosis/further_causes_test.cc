// A pair with implausible nominal values is not named where the budget ends before its halves are asked.
#include "diagnosis/further_causes.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "diagnosis/policy.h"
#include "diagnosis/trial.h"
#include "tests/estimation/made_record.h"
#include "tests/support/temp_dir.h"

namespace dynoproof::diagnosis {
namespace {

using estimation::RecordOf;
using estimation::Scenario;

/// Two effects that leave nothing but noise with a nominal value five standard deviations off, by a contest of a line's record.
class Halves : public ::testing::Test {
 protected:
  void SetUp() override {
    options_.out = folder_.path().string();
    Result<Parts> parts = Split(plan_, {record_}, {}, testing::BuiltIns());
    ASSERT_TRUE(parts.ok()) << parts.failure().ToString();
    inquiry_.emplace(problem_, plan_, *std::move(parts), std::vector{record_}, false, options_, Before());
    Contest& contest = answer_.contest;
    contest.contestants.push_back(inquiry_->Null(false));
    const estimation::Hypothesis both =
        inquiry_->NullModel(false)
            .With(*testing::BuiltIns().FindEffect("constant_load"), {"inertia", "I2", ""}, inquiry_->magnitudes())
            .With(*testing::BuiltIns().FindEffect("sensor_gain"), {"output", "T_shaft", ""}, inquiry_->magnitudes());
    Contestant pair(both);
    pair.levels = contest.null().levels;
    const std::size_t free = inquiry_->levels().free_run();
    for (estimation::Estimate& fit : pair.levels)
      fit.q = StartFrom(both, contest.null().hypothesis, contest.null().levels[free].q);
    const auto far = std::ranges::find(both.parameters(), "plant.inertia.I3", &estimation::Parameter::name);
    ASSERT_NE(far, both.parameters().end());
    pair.levels[free].q[far - both.parameters().begin()] = 5.0;
    ASSERT_GT(OffNominal(pair, free), policy::kImplausible);
    contest.contestants.push_back(std::move(pair));
    answer_.settled.level = free;
    answer_.settled.exact = true;
    answer_.settled.causes = {1};
    answer_.settled.verdict = Conclusion::kEffectFound;
  }

  test::TempDir folder_;
  DiagnoseOptions options_;
  Plan plan_ = Scenario("scenarios/diagnose/heavy_duty_lumped.toml", {"run.duration_s=0.3"});
  MappedRecord record_ = RecordOf(plan_, 0.01, {"T_shaft", "omega_1"});
  EstimationProblem problem_{plan_, {record_}, testing::BuiltIns()};
  std::optional<Inquiry> inquiry_;
  Answer answer_;
};

TEST_F(Halves, AreNotNamedWhereTheBudgetEndsBeforeTheyAreAsked) {
  options_.most_simulations = 0;
  ASSERT_TRUE(inquiry_->Spent());
  const std::optional<Answer> told = FromItsHalves(*inquiry_, answer_, answer_.contest);
  ASSERT_TRUE(told);
  EXPECT_EQ(told->settled.verdict, Conclusion::kUnexplained);
  EXPECT_TRUE(told->settled.causes.empty());
  EXPECT_EQ(told->settled.best, 1U);
  EXPECT_THAT(told->settled.reason, ::testing::HasSubstr("the search has spent its budget"));
  EXPECT_FALSE(inquiry_->complete());
}

TEST_F(Halves, AreNotAskedWhereNominalValuesAreNear) {
  answer_.contest.contestants[1].levels[answer_.settled.level].q = answer_.contest.contestants[1].hypothesis.start();
  options_.most_simulations = 0;
  EXPECT_FALSE(FromItsHalves(*inquiry_, answer_, answer_.contest));
  EXPECT_TRUE(inquiry_->complete());
}

}  // namespace
}  // namespace dynoproof::diagnosis
