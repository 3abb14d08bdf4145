// The checks of a run's course on courses made by hand.
#include "experiment/check_time_course.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace dynoproof {
namespace {

/// A rig that only names an output "y" [N m] and an input "r", and samples of two tones on a slope.
struct Course {
  Rig rig;
  Samples samples;
  Plan plan;

  Course() {
    rig.outputs.emplace_back();
    rig.outputs.back().name = "y";
    rig.outputs.back().unit = "N m";
    rig.inputs.emplace_back();
    rig.inputs.back().name = "r";
    samples.outputs.resize(1);
    samples.inputs.resize(1);
    for (int i = 0; i < 40000; ++i) {
      const double t = i * 1e-3, turn = 2.0 * std::numbers::pi;
      samples.time.push_back(t);
      samples.inputs[0].push_back(3.0);
      samples.outputs[0].push_back(3.0 +
                                   (t > 5.0 ? 0.5 * std::sin(turn * 2.03 * t) + 0.2 * std::sin(turn * 9.0 * t) : 0.0));
    }
  }
};

TEST(PeakCheck, FindsTheLargestToneBetweenTheBins) {
  Course course;
  CheckContext context(course.plan, course.rig, course.samples, "realtime");
  PeakCheck::Params params;
  params.signal = "y";
  params.figure = "torque_peak";
  params.band_Hz = {0.5, 100.0};
  params.between_Hz = {1.0, 5.0};
  params.during_s = {10.0, 30.0};
  const auto checks = PeakCheck(params).Run(context);
  ASSERT_EQ(checks.size(), 1u);
  EXPECT_EQ(checks[0].verdict, score::Verdict::kPass) << checks[0].explanation;
  EXPECT_NEAR(context.figures.at("torque_peak_hz").value, 2.03, 1e-3);
  EXPECT_NEAR(context.figures.at("torque_peak_Nm").value, 0.5, 1e-3);
  params.between_Hz = {3.0, 5.0};
  EXPECT_EQ(PeakCheck(params).Run(context)[0].verdict, score::Verdict::kFail);
  params.during_s = {1.0, 4.0};  // nothing moves there
  EXPECT_EQ(PeakCheck(params).Run(context)[0].verdict, score::Verdict::kFail);
}

TEST(FollowsCheck, TakesTheLargestDistance) {
  Course course;
  CheckContext context(course.plan, course.rig, course.samples, "realtime");
  FollowsCheck::Params params;
  params.signal = "y";
  params.reference = "r";
  params.largest = 0.71;
  EXPECT_EQ(FollowsCheck(params).Run(context)[0].verdict, score::Verdict::kPass);
  params.largest = 0.6;
  EXPECT_EQ(FollowsCheck(params).Run(context)[0].verdict, score::Verdict::kFail);
  params.during_s = {0.0, 5.0};
  EXPECT_EQ(FollowsCheck(params).Run(context)[0].verdict, score::Verdict::kPass);
  params.during_s = {50.0, 60.0};  // outside the run: nothing was compared
  EXPECT_EQ(FollowsCheck(params).Run(context)[0].verdict, score::Verdict::kFail);
}

}  // namespace
}  // namespace dynoproof
