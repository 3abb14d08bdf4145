// Data sheets as files, the choice of the coupling's mode, and the checks of a run's course.
#include "experiment/coupling.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "experiment/check_kinds.h"
#include "tests/support/temp_dir.h"

namespace dynoproof {
namespace {

using ::testing::HasSubstr;

std::string Sheet(const test::TempDir& folder, const char* text) { return folder.Write("sheet.csv", text).string(); }

TEST(CouplingTableFile, IsReadInItsOwnUnits) {
  const test::TempDir folder;
  const auto table = ReadCouplingTable(Sheet(folder, "nu,k,c\nHz,MN m/rad,kN m s/rad\n0,0.09,\n10,0.1,0.6\n"));
  ASSERT_TRUE(table.ok()) << table.failure().ToString();
  EXPECT_DOUBLE_EQ(table->nu[1], 20.0 * std::numbers::pi);
  EXPECT_DOUBLE_EQ(table->stiffness[0], 9e4);
  EXPECT_TRUE(std::isnan(table->damping[0]));
  EXPECT_DOUBLE_EQ(table->damping[1], 600.0);
}

TEST(CouplingTableFile, SaysWhatIsMissing) {
  const test::TempDir folder;
  const auto why = [&](const char* text) { return ReadCouplingTable(Sheet(folder, text)).failure().ToString(); };
  EXPECT_THAT(why("nu,k\n0,1\n"), HasSubstr("no column \"c\""));
  EXPECT_THAT(why("nu,k,c\nrad/s,kg,N m s/rad\n0,1,1\n"), HasSubstr("in \"kg\""));
  EXPECT_THAT(why("nu,k,c\n5,1,1\n4,1,1\n"), HasSubstr("do not rise"));
}

TEST(CouplingChoice, TakesTheModeThatTwistsTheCoupling) {
  // A stiff line of four with the coupling in the middle: the two halves swing against each other at
  // sqrt(k (1/3 + 1/30)), less the little that the shafts give.
  mechanics::Network network;
  network.nodes = {{"a", 1.0}, {"b", 2.0}, {"c", 10.0}, {"d", 20.0}};
  network.edges = {{"k1", 0, 1, 1e9, 5.0}, {"coupling", 1, 2, 7.0, 3.0}, {"k2", 2, 3, 1e9, 5.0}};
  const auto choice = ChooseCouplingMode(network, "coupling", 1e3);
  ASSERT_TRUE(choice.ok());
  EXPECT_NEAR(choice->nu_0, std::sqrt(1e3 * (1.0 / 3.0 + 1.0 / 30.0)), 1e-4);
  ASSERT_EQ(choice->modes.size(), 3u);
  EXPECT_GT(choice->modes[0].share, 0.99);
  EXPECT_LT(choice->modes[1].share + choice->modes[2].share, 1.0);
  EXPECT_THAT(ChooseCouplingMode(network, "k9", 1e3).failure().ToString(), HasSubstr("no shaft \"k9\""));
}

TEST(SteadyValues, KnowTheLawsOfCouplings) {
  const Value oil = {{"law", "oil_coupling"},
                     {"stiffness_Nm_per_rad", 78e3},
                     {"k_p_m3", 0.07},
                     {"kappa_p_per_s", 190.0},
                     {"kappa_w_Pa_per_rad", 2.2e6}};
  EXPECT_NEAR(SteadyValues(oil, 73.3)->damping, 705.5, 0.05);
  const Value plain = {{"stiffness_Nm_per_rad", 5.0}, {"damping_Nms_per_rad", 2.0}};
  EXPECT_EQ(SteadyValues(plain, 9.0)->damping, 2.0);
  EXPECT_FALSE(SteadyValues({{"law", "cubic_spring"}}, 1.0));
}

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

TEST(CouplingCheck, ReadsTheSteadyValues) {
  Course course;
  course.plan.root["plant"]["shaft"]["coupling"] =
      Value{{"law", "kelvin_voigt"}, {"stiffness_Nm_per_rad", 94e3}, {"damping_Nms_per_rad", 618.0}};
  CheckContext context(course.plan, course.rig, course.samples, "realtime");
  CouplingCheck::Params params;
  params.shaft = "coupling";
  params.nu_rad_per_s = 73.3;
  params.stiffness_Nm_per_rad = 94e3;
  params.damping_Nms_per_rad = 600.0;
  params.relative = 0.01;
  const auto checks = CouplingCheck(params).Run(context);
  ASSERT_EQ(checks.size(), 2u);
  EXPECT_EQ(checks[0].verdict, score::Verdict::kPass);
  EXPECT_EQ(checks[1].verdict, score::Verdict::kFail);  // 3 % off
  EXPECT_EQ(context.figures.at("coupling_c_Nms_per_rad").value, 618.0);
  params.shaft = "k9";
  EXPECT_EQ(CouplingCheck(params).Run(context)[0].verdict, score::Verdict::kFail);
}

}  // namespace
}  // namespace dynoproof
