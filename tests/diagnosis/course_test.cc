// What inputs do between their samples, asked beside a model that has the cause.
#include "diagnosis/course.h"

#include <gtest/gtest.h>

#include "diagnosis/trial.h"
#include "identification/between_samples.h"
#include "identification/estimation_problem.h"
#include "tests/estimation/made_record.h"

namespace dynoproof::diagnosis {
namespace {

using estimation::RecordOf;
using estimation::Scenario;
using estimation::WithEffect;
using identification::WithBetween;

// The torque goes up to 1900 Hz: every second tick is still enough for it.
class CourseOfInputs : public ::testing::Test {
 protected:
  /// Returns the course that is found from two models that were fitted to `record`: the nominal one and the one with the hidden friction.
  std::optional<Course> Beside(const MappedRecord& record) {
    const Registry& registry = testing::BuiltIns();
    const auto levels = Levels::Of(plan_, {record}, registry, 0.0, 1000);
    EXPECT_TRUE(levels.ok()) << levels.failure().ToString();
    const Magnitudes magnitudes = MagnitudesOf(EstimationProblem(plan_, {record}, registry));
    Contest contest;
    contest.contestants.emplace_back(NullHypothesis(plan_, false, **levels, registry));
    Contestant friction(contest.null().hypothesis.With(*registry.FindEffect("coulomb_friction"),
                                                       *ParsePlace("inertia:I5"), magnitudes));
    contest.contestants.push_back(friction);
    for (Contestant& one : contest.contestants)
      one.levels = {
          estimation::Fit(one.hypothesis, (**levels)[0], one.hypothesis.start(), {.renewals = 6, .near = true})};
    return OtherCourse(plan_, contest, **levels, registry);
  }

  const Plan plan_ = Scenario("scenarios/diagnose/heavy_duty_lumped.toml", {"run.duration_s=0.5"});
  const MappedRecord record_ = estimation::Slower(
      RecordOf(WithEffect(plan_, "coulomb_friction", "inertia:I5", {20.0}), 0.005, {"T_shaft", "omega_1"}), 2);
};

TEST_F(CourseOfInputs, IsToldByTheFrictionThatTheNominalModelLacks) {
  const std::optional<Course> course = Beside(WithBetween(record_, plan_, "linear"));
  ASSERT_TRUE(course);
  EXPECT_EQ(course->between, "band_limited_held");
  EXPECT_EQ(course->beside, "coulomb_friction@inertia:I5");
  EXPECT_LT(course->times, 0.2);
}

TEST_F(CourseOfInputs, StaysWhereTheGuessIsRightOrSomebodySaysIt) {
  EXPECT_FALSE(Beside(WithBetween(record_, plan_, "band_limited_held")));
  MappedRecord stated = record_;
  stated.between = {{"T_airgap", "linear"}};
  EXPECT_FALSE(Beside(stated));
}

}  // namespace
}  // namespace dynoproof::diagnosis
