// Data sheets as files, the choice of the coupling's mode, and the check of its steady values.
#include "thesis/coupling.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "tests/support/temp_dir.h"
#include "thesis/check_coupling.h"

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

TEST(CouplingCheck, ReadsTheSteadyValues) {
  const Rig rig;
  const Samples samples;
  Plan plan;
  plan.root["plant"]["shaft"]["coupling"] =
      Value{{"law", "kelvin_voigt"}, {"stiffness_Nm_per_rad", 94e3}, {"damping_Nms_per_rad", 618.0}};
  CheckContext context(plan, rig, samples, "realtime");
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
